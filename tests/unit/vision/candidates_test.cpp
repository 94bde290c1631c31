// SPDX-License-Identifier: MIT
// Candidates of a click: hands by their colour, pieces behind what passes in front, and a box that
// an arm holds.
#include "server/vision/segment/initialise/candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <random>

#include "server/vision/segment/appearance/graph_cut.hpp"
#include "server/vision/segment/appearance/skin.hpp"
#include "server/vision/segment/follow/select_initial_mask.hpp"
#include "tests/unit/vision/segment_runner.hpp"

namespace hapticast::server {
namespace {

const cv::Size kDrawn(320, 240);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kSkin(105, 140, 205);  // BGR
const cv::Scalar kDarkSkin(18, 24, 42);

cv::Mat grained(const cv::Mat& picture, std::mt19937& random) {
  cv::Mat noise(picture.size(), CV_8UC3);
  for (int v = 0; v < noise.rows; ++v) {
    for (int u = 0; u < noise.cols; ++u) {
      for (int c = 0; c < 3; ++c)
        noise.at<cv::Vec3b>(v, u)[c] = static_cast<unsigned char>(random() % 16);
    }
  }
  return picture + noise;
}

using test::imagesWith;

TEST(SkinColors, AFingerIsSkinAndSpecksAreNotInAnyLight) {
  const std::array lights{cv::Scalar(1, 1, 1), cv::Scalar(0.8, 0.95, 1.1)};
  for (const cv::Scalar& light : lights) {
    cv::Mat color(480, 640, CV_8UC3, kGrey.mul(light));
    cv::rectangle(color, {100, 100, 30, 200}, kSkin.mul(light), cv::FILLED);
    for (int v = 300; v < 460; v += 9) {
      for (int u = 300; u < 600; u += 9) cv::circle(color, {u, v}, 1, kSkin.mul(light), cv::FILLED);
    }
    const cv::Mat skin = SkinColors::adaptToLight(color).findSkin(color);
    const cv::Mat finger = skin({102, 110, 26, 180});
    EXPECT_GT(cv::countNonZero(finger), 0.9 * static_cast<double>(finger.total()));
    EXPECT_EQ(cv::countNonZero(skin({300, 0, 340, 480})), 0);
  }
}

// Colour and depth of a scene, and what is known of it.
struct Drawn {
  cv::Mat color, depth;
  std::vector<Plane> planes;
  DepthNoise noise;
  SkinColors skin;

  explicit Drawn(const cv::Scalar& ground)
      : color(kDrawn, CV_8UC3, ground), depth(kDrawn, CV_32FC1, cv::Scalar(1500)) {}
  void fill(const cv::Rect& box, const cv::Scalar& paint, double depth_mm) {
    color(box).setTo(paint);
    depth(box).setTo(depth_mm);
  }
  FrameImages finish(std::mt19937& random) {
    color = grained(color, random);
    noise = measureNoise(depth);
    skin = SkinColors::adaptToLight(color);
    return imagesWith(color, depth);
  }
};

TEST(MinimumCut, FollowsTheEdgeOfColourWhereTheEvidenceIsCoarse) {
  std::mt19937 random(3);
  const cv::Rect box(90, 70, 120, 90);
  Drawn drawn(kGrey);
  drawn.fill(box, cv::Scalar(40, 40, 200), 700.0);
  const FrameImages images = drawn.finish(random);
  const FrameContext scene{images, drawn.planes, drawn.noise, drawn.skin};
  const GraphRoi view = GraphRoi::makeWithValleys(scene, {{0, 0}, kDrawn}, 1e6);
  cv::Mat unary(kDrawn, CV_32FC1, cv::Scalar(-0.1));
  cv::circle(unary, {150, 115}, 20, cv::Scalar(5), cv::FILLED);   // surely the object, ...
  cv::rectangle(unary, {70, 50, 160, 130}, cv::Scalar(0.2), 30);  // ... and perhaps
  unary.row(0).setTo(-5);
  cv::Mat truth = cv::Mat::zeros(kDrawn, CV_8UC1);
  truth(box).setTo(255);
  const cv::Mat cut = minimumCut({unary}, view, drawn.noise, kCutOfCandidate);
  EXPECT_GT(test::overlap(cut, truth), 0.95);
}

TEST(CandidatesJoined, AFingerDoesNotSplitAnObjectAndTheBackgroundDoes) {
  std::mt19937 random(5);
  const cv::Rect whole(100, 80, 60, 100);
  const cv::Rect between(100, 120, 60, 20);
  for (const bool finger : {true, false}) {
    Drawn drawn(kGrey);
    drawn.fill(whole, cv::Scalar(40, 40, 200), 700.0);
    drawn.fill(between, finger ? kSkin : kGrey, finger ? 680.0 : 1500.0);
    const FrameImages images = drawn.finish(random);
    const FrameContext scene{images, drawn.planes, drawn.noise, drawn.skin};
    const GraphRoi view = GraphRoi::makeWithValleys(scene, {{0, 0}, kDrawn}, 1e6);
    cv::Mat mask = cv::Mat::zeros(kDrawn, CV_8UC1);
    mask(whole).setTo(255);
    mask(between).setTo(0);
    cv::Mat main = mask.clone();
    main.rowRange(between.br().y, mask.rows).setTo(0);
    const double px_per_mm = pixelsPerMm(700.0, kDrawn);
    const cv::Mat joined = mergeOccludedParts(view, mask, main, px_per_mm);
    EXPECT_EQ(cv::countNonZero(joined), cv::countNonZero(finger ? mask : main));
  }
}

// Left half dark skin, right half skin.
Drawn darkAndLightSkin() {
  Drawn out(kGrey);
  out.fill({40, 40, 80, 160}, kDarkSkin, 700.0);
  out.fill({200, 40, 80, 160}, kSkin, 700.0);
  return out;
}
const cv::Rect kInDark(44, 44, 72, 152);
const cv::Rect kInLight(204, 44, 72, 152);

TEST(SkinColors, DarkSkinIsSkinOnlyOnRequest) {
  std::mt19937 random(17);
  Drawn drawn = darkAndLightSkin();
  const FrameImages images = drawn.finish(random);
  const cv::Mat skin = drawn.skin.findSkin(images.color);
  EXPECT_LT(cv::mean(skin(kInDark))[0], 0.05 * 255);
  EXPECT_GT(cv::mean(skin(kInLight))[0], 0.95 * 255);
  const cv::Mat with_dark = drawn.skin.findWithDark(images.color);
  EXPECT_GT(cv::mean(with_dark(kInDark))[0], 0.95 * 255);
  EXPECT_GT(cv::mean(with_dark(kInLight))[0], 0.95 * 255);
}

TEST(FindHands, TheLearntHandCountsAndNoOtherSkin) {
  std::mt19937 random(19);
  Drawn drawn = darkAndLightSkin();
  const FrameImages images = drawn.finish(random);
  FrameContext scene{images, drawn.planes, drawn.noise, drawn.skin};
  const cv::Rect whole({0, 0}, kDrawn);
  cv::Mat hands = scene.findHands(whole, kDrawn);
  EXPECT_LT(cv::mean(hands(kInDark))[0], 0.05 * 255);
  EXPECT_GT(cv::mean(hands(kInLight))[0], 0.95 * 255);
  scene.hand = cv::Mat::zeros(kDrawn, CV_8UC1);
  scene.hand.colRange(0, 160).setTo(255);
  hands = scene.findHands(whole, kDrawn);
  EXPECT_GT(cv::mean(hands(kInDark))[0], 0.95 * 255);
  EXPECT_LT(cv::mean(hands(kInLight))[0], 0.05 * 255);
  EXPECT_LT(cv::mean(hands({130, 40, 30, 160}))[0], 0.05 * 255);  // grey: no colour of skin
}

TEST(CandidatesAtPoint, ABoxThatAnArmHoldsIsTakenWithoutTheArm) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 6; ++trial) {
    const cv::Rect box(110 + static_cast<int>(random() % 20), 60 + static_cast<int>(random() % 20),
                       60, 70);
    Drawn drawn(kGrey);
    drawn.fill({box.x + 20, box.br().y - 10, 35, kDrawn.height - box.br().y + 10}, kSkin, 705.0);
    drawn.fill(box, cv::Scalar(170, 60, 40), 700.0);
    const FrameImages images = drawn.finish(random);
    const SceneContext scene{drawn.noise, drawn.planes, drawn.skin, {}};
    const cv::Point click(box.x + 10 + static_cast<int>(random() % 40),
                          box.y + 10 + static_cast<int>(random() % 50));
    const ChosenStart start = selectInitialMask(images, scene, click, {});
    ASSERT_TRUE(start.object) << trial;
    cv::Mat truth = cv::Mat::zeros(kDrawn, CV_8UC1);
    truth(box).setTo(255);
    EXPECT_GT(test::overlap(start.object->mask(), truth), 0.9) << trial << " at " << click;
  }
}

// An arm, bare up to the picture's border, with a box of the colour `paint` in its hand.
struct HeldBox {
  Drawn drawn{kGrey};
  cv::Mat truth = cv::Mat::zeros(kDrawn, CV_8UC1);
  cv::Rect box;

  HeldBox(const cv::Scalar& paint, const cv::Size& size, std::mt19937& random) {
    box = {{110 + static_cast<int>(random() % 20), 60 + static_cast<int>(random() % 20)}, size};
    const int arm = size.width / 2;
    drawn.fill({box.x + arm / 2, box.br().y - size.height / 6, std::max(arm, 30),
                kDrawn.height - box.br().y + size.height / 6},
               kSkin, 705.0);
    drawn.fill(box, paint, 700.0);
    truth(box).setTo(255);
  }
  ChosenStart choose(const FrameImages& images, const cv::Point& click) const {
    return selectInitialMask(images, {drawn.noise, drawn.planes, drawn.skin, {}}, click, {});
  }
};

TEST(CandidatesAtPoint, AThingOfSkinsColourIsChosenWithoutTheArm) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 6; ++trial) {
    HeldBox held(cv::Scalar(60, 75, 140), {60, 70}, random);
    const FrameImages images = held.drawn.finish(random);
    const cv::Mat skin = held.drawn.skin.findSkin(images.color);
    ASSERT_GT(cv::countNonZero(skin & held.truth), 0.5 * cv::countNonZero(held.truth));
    const cv::Point click(held.box.x + 10 + static_cast<int>(random() % 40),
                          held.box.y + 10 + static_cast<int>(random() % 40));
    const ChosenStart start = held.choose(images, click);
    ASSERT_TRUE(start.object) << trial;
    EXPECT_GT(test::overlap(start.object->mask(), held.truth), 0.85) << trial << " at " << click;
  }
}

TEST(CandidatesAtPoint, ASmallThingInAHandIsChosen) {
  std::mt19937 random(13);
  for (int trial = 0; trial < 6; ++trial) {
    HeldBox held(cv::Scalar(170, 60, 40), {14, 14}, random);
    const FrameImages images = held.drawn.finish(random);
    const ChosenStart start = held.choose(images, held.box.tl() + cv::Point(7, 6));
    ASSERT_TRUE(start.object) << trial;
    EXPECT_GT(test::overlap(start.object->mask(), held.truth), 0.7) << trial;
  }
}

TEST(CandidatesAtPoint, DistinctCandidatesAreRankedAfterTheChosenOne) {
  std::mt19937 random(29);
  HeldBox held(cv::Scalar(170, 60, 40), {60, 70}, random);
  const FrameImages images = held.drawn.finish(random);
  const ChosenStart start = held.choose(images, held.box.tl() + cv::Point(20, 20));
  ASSERT_TRUE(start.object);
  ASSERT_GE(start.ranked.size(), 2U);
  EXPECT_EQ(test::overlap(start.ranked[0].mask(), start.object->mask()), 1.0);
  for (std::size_t i = 0; i < start.ranked.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_LT(test::overlap(start.ranked[i].mask(), start.ranked[k].mask()), 0.9) << i << k;
  }
}

TEST(CandidatesAtPoint, TheChoiceIsTheSameHoweverThePictureIsTurned) {
  std::mt19937 random(17);
  for (const cv::Scalar& paint : {cv::Scalar(170, 60, 40), cv::Scalar(60, 75, 140)}) {
    HeldBox held(paint, {60, 70}, random);
    const FrameImages images = held.drawn.finish(random);
    for (const cv::Point& click :
         {held.box.tl() + cv::Point(20, 20), cv::Point(held.box.x + 35, kDrawn.height - 40)}) {
      const ChosenStart upright = held.choose(images, click);
      ASSERT_TRUE(upright.object);
      cv::Mat at = cv::Mat::zeros(kDrawn, CV_8UC1);
      at.at<unsigned char>(click) = 255;
      for (const auto& [turn, turn_back] :
           {std::pair(cv::ROTATE_90_CLOCKWISE, cv::ROTATE_90_COUNTERCLOCKWISE),
            std::pair(cv::ROTATE_180, cv::ROTATE_180),
            std::pair(cv::ROTATE_90_COUNTERCLOCKWISE, cv::ROTATE_90_CLOCKWISE)}) {
        cv::Mat color, depth, turned_at, back;
        cv::rotate(images.color, color, turn);
        cv::rotate(images.depth, depth, turn);
        cv::rotate(at, turned_at, turn);
        cv::Point turned_click;
        cv::minMaxLoc(turned_at, nullptr, nullptr, nullptr, &turned_click);
        const ChosenStart turned = held.choose(imagesWith(color, depth), turned_click);
        ASSERT_TRUE(turned.object);
        cv::rotate(turned.object->mask(), back, turn_back);
        EXPECT_GT(test::overlap(back, upright.object->mask()), 0.95) << click << " turn " << turn;
      }
    }
  }
}

TEST(CandidatesAtPoint, TheExplanationNamesEachCandidateAndTheChosenOne) {
  std::mt19937 random(19);
  HeldBox held(cv::Scalar(170, 60, 40), {60, 70}, random);
  const FrameImages images = held.drawn.finish(random);
  const ChosenStart start = held.choose(images, held.box.tl() + cv::Point(20, 20));
  ASSERT_GE(start.explanation.size(), 2U);
  const auto chosen = [](const std::string& line) {
    return line.find(": chosen: ") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(start.explanation.begin(), start.explanation.end(), chosen), 1);
  for (const std::string& line : start.explanation)
    EXPECT_NE(line.find("score "), std::string::npos) << line;
}

TEST(CandidatesAutomatic, AThingInAHandCountsMoreThanAFartherThingThatStandsAlone) {
  std::mt19937 random(23);
  for (int trial = 0; trial < 4; ++trial) {
    HeldBox held(cv::Scalar(170, 60, 40), {60, 70}, random);
    held.drawn.fill({230, 110, 70, 60}, cv::Scalar(40, 120, 60), 1100.0);
    const FrameImages images = held.drawn.finish(random);
    const ChosenStart start =
        selectAutomatically(images, {held.drawn.noise, held.drawn.planes, held.drawn.skin, {}}, {});
    ASSERT_TRUE(start.object) << trial;
    EXPECT_GT(test::overlap(start.object->mask(), held.truth), 0.85) << trial;
  }
}

TEST(CandidatesAutomatic, OfThingsThatStandAloneTheNearestInTheMiddleIsChosen) {
  std::mt19937 random(29);
  Drawn drawn(kGrey);
  const cv::Rect middle(130, 80, 60, 70);
  drawn.fill(middle, cv::Scalar(170, 60, 40), 700.0);
  drawn.fill({20, 160, 50, 60}, cv::Scalar(40, 120, 60), 650.0);
  drawn.fill({230, 60, 60, 60}, cv::Scalar(40, 60, 160), 1000.0);
  const FrameImages images = drawn.finish(random);
  const ChosenStart start =
      selectAutomatically(images, {drawn.noise, drawn.planes, drawn.skin, {}}, {});
  ASSERT_TRUE(start.object);
  cv::Mat truth = cv::Mat::zeros(kDrawn, CV_8UC1);
  truth(middle).setTo(255);
  EXPECT_GT(test::overlap(start.object->mask(), truth), 0.9);
}

TEST(CandidatesAutomatic, NothingIsChosenBeforeABareBackground) {
  std::mt19937 random(31);
  Drawn drawn(kGrey);
  const FrameImages images = drawn.finish(random);
  const ChosenStart start =
      selectAutomatically(images, {drawn.noise, drawn.planes, drawn.skin, {}}, {});
  EXPECT_FALSE(start.object);
  EXPECT_TRUE(start.explanation.empty());
}

TEST(Planes, TheFrontOfAnObjectIsNoSupport) {
  cv::Mat depth(kDrawn, CV_32FC1, cv::Scalar(1500));
  const cv::Rect front(100, 60, 80, 80);
  depth(front).setTo(700);
  depth(cv::Rect(180, 60, 40, 80)).setTo(700);  // a hand at the same depth
  cv::Mat mask = cv::Mat::zeros(kDrawn, CV_8UC1);
  mask(front).setTo(255);
  Plane plane;
  plane.c = 1.0 / 700.0;
  plane.share = 0.12;
  std::vector<Plane> planes{plane};
  findSupports(depth, mask, planes);
  EXPECT_FALSE(planes[0].support);
  depth(front).setTo(600);  // now the object stands in front of that plane
  findSupports(depth, mask, planes);
  EXPECT_TRUE(planes[0].support);
}

}  // namespace
}  // namespace hapticast::server
