// SPDX-License-Identifier: MIT
// What the tracker does with a mask in doubt: the correlation filter follows the object's box, a
// piece that a hand left behind goes, and a mask that stayed on the background is lost.
#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgproc.hpp>

#include "server/vision/segment/follow/box_tracker.hpp"
#include "server/vision/segment/follow/select_initial_mask.hpp"
#include "server/vision/segment/follow/tracked_mask.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/unit/vision/segment_runner.hpp"

namespace hapticast::server {
namespace {

const cv::Scalar kBlobColor(200, 40, 160);

void paintPart(RgbdFrame& frame, const cv::Rect& part, const cv::Scalar& color, double depth_mm) {
  frame.color(part).setTo(color);
  frame.depth(part).setTo(depth_mm);
}

SceneContext makeScene(const FrameImages& images) {
  SceneContext scene;
  scene.skin = SkinColors::adaptToLight(images.color);
  scene.noise = measureNoise(images.depth);
  return scene;
}

TEST(BoxTracker, FollowsATexturedBallAndReducesALargePicture) {
  for (const double larger : {1.0, 3.0}) {
    const test::BallScene scene;
    const auto draw = [&](int i) {
      cv::Mat out;
      cv::resize(scene.frame(0, 100 + 5.0 * i, 110 + 2.0 * i).color, out, {}, larger, larger);
      return out;
    };
    const auto box = [&](int i) {
      const cv::Rect2d small(60 + 5.0 * i, 70 + 2.0 * i, 80, 80);
      return cv::Rect(cv::Rect2d(larger * small.x, larger * small.y, larger * small.width,
                                 larger * small.height));
    };
    BoxTracker tracker(draw(0), box(0));
    for (int i = 1; i < 15; ++i) {
      const auto found = tracker.next(draw(i));
      ASSERT_TRUE(found) << i;
      EXPECT_GT(double((*found & box(i)).area()) / (*found | box(i)).area(), 0.7) << i;
    }
  }
}

TEST(BoxTracker, BoxesThatTheFilterCannotFollowAreNotFollowed) {
  const test::BallScene scene;
  const cv::Mat picture = scene.frame(0, 100, 110).color;
  for (const cv::Rect& box :
       {cv::Rect(20, 0, 8, 240), cv::Rect(0, 100, 320, 9), cv::Rect(5, 5, 4, 4),
        cv::Rect(0, 0, 320, 240), cv::Rect(310, 230, 10, 10)}) {
    BoxTracker tracker(picture, box);
    for (int i = 0; i < 4; ++i) {
      const auto found =
          tracker.next(i < 2 ? picture : cv::Mat(picture.size(), CV_8UC3, cv::Scalar(7)));
      EXPECT_TRUE(!found || (*found & cv::Rect({0, 0}, picture.size())) == *found) << box;
    }
  }
}

// A blob with the colour of an arm beside it begins as a part of the mask, and is apart from the
// ball.
TEST(TrackedMask, APieceOfOtherColoursThatStaysApartGoes) {
  const test::BallScene scene;
  RgbdFrame frame = scene.frame(0, 100, 120);
  const cv::Rect blob(190, 100, 24, 24);
  const cv::Rect arm(218, 60, 80, 120);
  for (const cv::Rect& part : {blob, arm}) paintPart(frame, part, kBlobColor, 720.0);
  const FrameImages images = test::imagesWith(frame.color, frame.depth);
  cv::Mat first = frame.mask * 255;
  first(blob).setTo(255);
  const SceneContext around = makeScene(images);
  TrackedMask object(1, first, images, around, 0);
  int frames = 0;
  while (cv::countNonZero(object.mask()(blob)) > 0 && frames < 10) {
    object.update(images, ObjectFlow{.reliable = true, .tracks = {}}, around);
    ++frames;
  }
  EXPECT_GE(frames, 3);
  EXPECT_LE(frames, 4);
  EXPECT_GT(test::overlap(object.mask(), frame.mask * 255), 0.9);
}

// Two halves of the ball beside a bar: both have the object's colours, so both stay.
TEST(TrackedMask, APieceOfTheSameColoursStays) {
  const test::BallScene scene;
  RgbdFrame frame = scene.frame(0, 100, 120);
  const cv::Rect bar(96, 60, 12, 120);
  paintPart(frame, bar, kBlobColor, 500.0);
  const FrameImages images = test::imagesWith(frame.color, frame.depth);
  cv::Mat first = frame.mask * 255;
  first(bar).setTo(0);
  const SceneContext around = makeScene(images);
  TrackedMask object(1, first, images, around, 0);
  for (int i = 0; i < 10; ++i)
    object.update(images, ObjectFlow{.reliable = true, .tracks = {}}, around);
  EXPECT_GT(test::overlap(object.mask(), first), 0.85);
}

TEST(ContourMemory, TheHandsColoursAreEvidenceAgainstTheObjectUnlessItHasThem) {
  const auto fill = [](const cv::Scalar& color) {
    const cv::Mat picture(20, 20, CV_8UC3, color);
    return ColorHistogram::fromImage(picture, cv::Mat::ones(20, 20, CV_8UC1));
  };
  const cv::Scalar red(40, 40, 200);
  const cv::Scalar skin(105, 140, 205);
  const auto computeEvidence = [](const ContourMemory& memory, const cv::Scalar& color) {
    const cv::Vec3b bgr(cv::saturate_cast<uchar>(color[0]), cv::saturate_cast<uchar>(color[1]),
                        cv::saturate_cast<uchar>(color[2]));
    return computeColorEvidence(memory)[ColorHistogram::binIndex(bgr)];
  };
  ContourMemory memory;
  memory.first = memory.now = fill(red);
  memory.background = fill({200, 200, 200});
  const float before = computeEvidence(memory, skin);
  memory.hand = fill(skin);
  EXPECT_LT(computeEvidence(memory, skin), before - 0.5F);
  EXPECT_GT(computeEvidence(memory, red), 1.0F);
  memory.hand = fill(red);  // a glove of the object's own colour
  EXPECT_GT(computeEvidence(memory, red), 1.0F);
}

// A stop-motion clip: the ball jumps by more than its width every `hold` frames.
TEST(Segment, AMaskOfAJumpingBallDoesNotStayOnTheBackground) {
  test::BallScene scene;
  scene.with_mask = false;
  scene.radius_px = 24;
  VisionSettings settings;
  settings.segment = SegmentMode::kBand;
  settings.object_points = {{{60, 60}}};
  const std::array<Vec2, 4> places{Vec2(60, 60), Vec2(240, 60), Vec2(240, 180), Vec2(70, 170)};
  for (const std::uint64_t hold : {1U, 2U, 6U}) {
    std::uint32_t id = 1;
    test::Runner runner{scene.info(), makeSegmenter(settings, false, id), {}, {}};
    int wrong = 0;
    int found = 0;
    for (std::uint64_t i = 0; i < 24; ++i) {
      const Vec2& at = places[(i / hold) % places.size()];
      cv::Mat truth = cv::Mat::zeros(scene.height, scene.width, CV_8UC1);
      cv::circle(truth, {int(at.x()), int(at.y())}, 22, cv::Scalar(255), cv::FILLED);
      for (const Segment& segment : runner.next(scene.frame(i, at.x(), at.y()))) {
        const double iou = test::overlap(segment.mask, truth);
        if (iou > 0.7) ++found;
        if (iou < 0.1 && segment.quality >= 1.0) ++wrong;
      }
    }
    EXPECT_LE(wrong, 3) << hold << ": the frame of a jump may still carry the mask";
    EXPECT_GE(found, hold == 6 ? 9 : 4) << hold;
  }
}

// A torso from the border with a lap in the middle, and a ball beside it.
TEST(DoubtfulMaskChoice, ALapIsNoHeldObject) {
  test::BallScene scene;
  scene.width = 640;
  scene.height = 480;
  RgbdFrame frame = scene.frame(0, 90, 240);
  const cv::Rect torso(280, 0, 90, 230);
  const cv::Rect lap(200, 200, 260, 150);
  paintPart(frame, torso, cv::Scalar(90, 60, 40), 900.0);
  paintPart(frame, lap, cv::Scalar(30, 30, 30), 890.0);
  const FrameImages images = test::imagesWith(frame.color, frame.depth);
  const ChosenStart start = selectAutomatically(images, makeScene(images), {});
  ASSERT_TRUE(start.object);
  EXPECT_GT(test::overlap(start.object->mask(), frame.mask * 255), 0.8);
}

}  // namespace
}  // namespace hapticast::server
