// SPDX-License-Identifier: MIT
// Annotations of later frames: the frame of a point, its effect on the model of the
// frames before and after, what drawn masks do.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/follow/tracked_mask.hpp"
#include "server/vision/segment/initialise/refine_clicks.hpp"
#include "server/vision/segment/make_segmenter.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/unit/vision/segment_runner.hpp"

namespace hapticast::server {
namespace {

constexpr double kWordFps = 25.0;
constexpr int kWordFrames = 20;

FramePair at(double time_s, double gap = 1.0) {
  FramePair out;
  out.clip_time_s = time_s;
  out.frame_s = 1 / kWordFps;
  out.last_clip_time_s = time_s > 0.0 ? time_s - gap * out.frame_s : -1.0;
  return out;
}

TEST(AnnotationTrack, APointAppliesToTheNearestFrameOnly) {
  VisionSettings settings;
  settings.object_points = {{{5, 6}, 0.0}, {{7, 8}, 0.41}};
  settings.not_points = {{{9, 10}, 0.0}, {{11, 12}, 0.79}};
  const AnnotationTrack script(settings);
  EXPECT_EQ(script.atStart().on, (std::vector<ObjectPoint>{{{5, 6}, 1}}));
  EXPECT_EQ(script.atStart().off, std::vector<cv::Point>{cv::Point(9, 10)});
  EXPECT_TRUE(script.pointsLater());
  int spoken = 0;
  for (int i = 0; i < 30; ++i) {
    const Annotation word = script.findAnnotation(at(i / kWordFps));
    EXPECT_EQ(word.on.size(), i == 10 ? 1U : 0U) << i;
    EXPECT_EQ(word.off.size(), i == 20 ? 1U : 0U) << i;
    EXPECT_EQ(script.hasLaterAnnotation(at(i / kWordFps)), i < 20) << i;
    if (!word.empty()) ++spoken;
  }
  EXPECT_EQ(spoken, 2);
}

TEST(AnnotationTrack, NoPointIsMissedWhereFramesAreMissingNorRightAfterTheStart) {
  VisionSettings settings;
  settings.object_points = {{{5, 6}, 0.001}};
  settings.not_points = {{{9, 10}, 0.41}};
  const AnnotationTrack script(settings);
  EXPECT_EQ(script.findAnnotation(at(0)).on.size(), 1U);
  EXPECT_TRUE(script.findAnnotation(at(1 / kWordFps)).empty());
  EXPECT_EQ(script.findAnnotation(at(13 / kWordFps, 6)).off.size(), 1U)
      << "frames 8 to 12 are missing";
}

// A red square with a blue bar that is one with it in depth, both grained.
struct SquareAndBar {
  cv::Mat color{200, 300, CV_8UC3, cv::Scalar(90, 160, 90)};
  cv::Mat depth{200, 300, CV_32FC1, cv::Scalar(900)};
  cv::Mat square = cv::Mat::zeros(200, 300, CV_8UC1);
  cv::Mat bar = cv::Mat::zeros(200, 300, CV_8UC1);

  SquareAndBar() {
    square(cv::Rect(80, 60, 70, 70)).setTo(255);
    bar(cv::Rect(150, 80, 80, 30)).setTo(255);
    color.setTo(cv::Scalar(60, 60, 190), square);
    color.setTo(cv::Scalar(190, 90, 40), bar);
    depth.setTo(700, square | bar);
    for (int v = 0; v < color.rows; ++v) {
      for (int u = 0; u < color.cols; ++u) {
        const double grain = 30 * test::paint(3 * u, 3 * v);
        color.at<cv::Vec3b>(v, u) += cv::Vec3b::all(static_cast<uchar>(grain));
      }
    }
  }
  [[nodiscard]] FrameImages images() const {
    cv::Mat gray;
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    return {color, gray, depth, {}, {}};
  }
};

TEST(AnnotationsTest, ANegativePointRemovesItsObjectOnly) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  const cv::Mat both = drawn.square | drawn.bar;
  const cv::Mat left = refineWithClicks(scene.view(images), both, {{}, {{200, 95}}, {}}, {});
  EXPECT_GT(test::overlap(left, drawn.square), 0.93);
  const cv::Mat right = refineWithClicks(scene.view(images), both, {{}, {{110, 95}}, {}}, {});
  EXPECT_LT(test::overlap(right, drawn.square), 0.1) << "the author may mean the bar";
}

TEST(AnnotationsTest, APositivePointAddsItsObjectOnly) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  cv::Mat half = drawn.square.clone();
  half(cv::Rect(0, 0, 300, 85)).setTo(0);
  const cv::Mat whole = refineWithClicks(scene.view(images), half, {{{{110, 75}, 0}}, {}, {}}, {});
  EXPECT_GT(test::overlap(whole, drawn.square), 0.93);
}

// The square and its half are things of their own, the square with the bar is not.
TEST(AnnotationsTest, APointThatMakesTheMaskTooLargeAddsItsDiscUnlessTheScoreImproves) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  const double most_px = 1.2 * cv::countNonZero(drawn.square);
  const Annotation on_bar{{{{190, 95}, 0}}, {}, {}};
  const cv::Mat free = refineWithClicks(scene.view(images), drawn.square, on_bar, {});
  EXPECT_GT(cv::countNonZero(free), most_px);
  const cv::Mat limited = refineWithClicks(scene.view(images), drawn.square, on_bar, {}, most_px);
  EXPECT_GT(test::overlap(limited, drawn.square), 0.95);
  EXPECT_NE(limited.at<unsigned char>(95, 190), 0) << "the author's point is on the object";
  cv::Mat half = drawn.square.clone();
  half(cv::Rect(0, 0, 300, 95)).setTo(0);
  const cv::Mat whole = refineWithClicks(scene.view(images), half, {{{{110, 75}, 0}}, {}, {}}, {},
                                         1.2 * cv::countNonZero(half));
  EXPECT_GT(test::overlap(whole, drawn.square), 0.93);
}

// The first mask holds object and hand, as after a click on a thing in a hand.
TEST(AnnotationsTest, NoNegativePointEmptiesAnObjectThatHoldsAPointOfTheAuthor) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  TrackedMask object(1, drawn.square | drawn.bar, images, scene, 0);
  object.rememberAppearance(images, scene);
  object.addAnchor({190, 95});
  for (const cv::Point& off : {cv::Point(110, 95), cv::Point(90, 70)}) {
    object.correct(images, scene, {{}, {off}, {}});
    ASSERT_TRUE(object.present()) << off;
    EXPECT_GT(test::overlap(object.mask(), drawn.bar), 0.85) << off;
  }
}

TEST(AnnotationsTest, OfTwoPointsThatContradictEachOtherTheLaterOneCounts) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  TrackedMask object(1, drawn.square | drawn.bar, images, scene, 0);
  object.addAnchor({190, 95});
  object.correct(images, scene, {{}, {{192, 96}}, {}});
  ASSERT_TRUE(object.present());
  EXPECT_GT(test::overlap(object.mask(), drawn.square), 0.9);
  object.correct(images, scene, {{{{190, 95}, 0}}, {}, {}});
  ASSERT_TRUE(object.present());
  EXPECT_GT(test::overlap(object.mask(), drawn.square | drawn.bar), 0.85);
}

TEST(AnnotationsTest, APointOnTheRimChangesTheRimOnly) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  const cv::Mat less = refineWithClicks(scene.view(images), drawn.square, {{}, {{82, 95}}, {}}, {});
  EXPECT_GT(test::overlap(less, drawn.square), 0.93);
  const cv::Mat more =
      refineWithClicks(scene.view(images), drawn.square, {{{{152, 95}, 0}}, {}, {}}, {});
  EXPECT_GT(test::overlap(more, drawn.square), 0.8) << "the bar has half of its area";
}

TEST(AnnotationsTest, ColorsThatAreNotItSpeakAgainstItButForItsOwn) {
  const SquareAndBar drawn;
  const FrameImages images = drawn.images();
  const SceneContext scene{measureNoise(drawn.depth), {}, {}, {}};
  NegativeColors avoided;
  addNegativeSample(scene.view(images), {200, 95}, avoided);
  ContourMemory memory;
  const ObjectRoi patch = makePatch(images, drawn.square);
  updateMemory(patch, drawn.square(patch.box), memory);
  const auto meanOver = [&](const cv::Mat& where) {
    const std::vector<float> evidence = computeColorEvidence(memory);
    double sum = 0.0;
    for (int v = 0; v < where.rows; ++v) {
      for (int u = 0; u < where.cols; ++u) {
        if (where.at<uchar>(v, u) != 0)
          sum += double(evidence[ColorHistogram::binIndex(drawn.color.at<cv::Vec3b>(v, u))]);
      }
    }
    return sum / cv::countNonZero(where);
  };
  memory.avoided = avoided.histogram;
  EXPECT_LT(meanOver(drawn.bar), -2.0);
  EXPECT_GT(meanOver(drawn.square), 2.0);
  NegativeColors own;
  addNegativeSample(scene.view(images), {110, 95}, own);
  memory.avoided = own.histogram;
  EXPECT_GT(meanOver(drawn.square), 1.5) << "what looks like it cannot be told by colour";
}

/// A ball that goes to the right, and what vision's first step makes of it.
struct Played {
  test::BallScene scene{.with_mask = false};
  VisionSettings settings;
  ClipAnnotations annotations;
  std::map<int, cv::Mat> drawn;  // by frame, 0 / 1
  int hidden_until = 0;

  [[nodiscard]] RgbdFrame frame(int i) const {
    const double u = i < hidden_until ? -100 : 90 + 4.0 * i;
    RgbdFrame out = scene.frame(static_cast<std::uint64_t>(i), u, 110);
    out.clip_time_s = i / kWordFps;
    if (drawn.contains(i)) out.mask = drawn.at(i);
    return out;
  }
  [[nodiscard]] cv::Mat truth(int i) const {
    test::BallScene with = scene;
    with.with_mask = true;
    const double u = i < hidden_until ? -100 : 90 + 4.0 * i;
    return with.frame(0, u, 110).mask == 1;
  }
  std::vector<std::vector<Segment>> play(bool open, bool live = false) {
    SourceInfo info = scene.info(kWordFps);
    info.key_masks = !drawn.empty();
    std::uint32_t id = 1;
    annotations.open = open;
    const auto segmenter = makeSegmenter(settings, false, id, live ? nullptr : &annotations);
    FramePairs pairs(info, true);
    std::vector<std::vector<Segment>> out;
    std::vector<Segment> last;
    for (int i = 0; i < kWordFrames; ++i) {
      const FramePair pair = pairs.push(frame(i), i / kWordFps);
      Flows flows;
      for (const Segment& s : last)
        flows[s.id] = trackObject(pair.last.gray, pair.now.gray, s.mask, {0, 0});
      out.push_back(last = segmenter->next(pair, flows));
    }
    return out;
  }
};

cv::Mat lowerHalf(const cv::Mat& mask) {
  cv::Mat out = mask.clone();
  out(cv::Rect(0, 0, out.cols, 110)).setTo(0);
  return out;
}

TEST(AnnotationsTest, ADrawnMaskIsTakenAsItIsAndCarriedToTheFramesBeforeAndAfter) {
  Played played;
  played.settings.object_points = {{{90, 110}}};
  played.drawn[14] = lowerHalf(played.truth(14)) / 255;
  for (const bool open : {true, false}) {
    const auto segments = played.play(open);
    for (const auto& frame : segments) ASSERT_EQ(frame.size(), 1U);
    EXPECT_EQ(test::overlap(segments[14][0].mask, lowerHalf(played.truth(14))), 1.0);
    EXPECT_GT(test::overlap(segments[3][0].mask, played.truth(3)), 0.9)
        << "nearer to the click in time";
    if (open) continue;
    for (const int i : {12, 13, 15}) {
      const cv::Mat whole = played.truth(i);
      EXPECT_GT(test::overlap(segments[i][0].mask, lowerHalf(whole)),
                test::overlap(segments[i][0].mask, whole))
          << i;
    }
  }
}

TEST(AnnotationsTest, DrawnMasksAloneBeginAnObjectWhereItIsSeenFirst) {
  Played played;
  played.hidden_until = 4;
  played.drawn[10] = played.truth(10) / 255;
  (void)played.play(true);
  const auto segments = played.play(false);
  for (int i = 0; i < kWordFrames; ++i) {
    if (i < 4) {
      EXPECT_TRUE(segments[i].empty()) << i;
    } else if (i > 4) {
      ASSERT_EQ(segments[i].size(), 1U) << i;
      EXPECT_GT(test::overlap(segments[i][0].mask, played.truth(i)), 0.85) << i;
    }
  }
}

TEST(AnnotationsTest, AClipThatBeginsWithTheObjectHiddenIsStartedByALaterPoint) {
  Played played;
  played.hidden_until = 5;
  played.settings.object_points = {{{130, 110}, 10 / kWordFps}};
  (void)played.play(true);
  const auto segments = played.play(false);
  EXPECT_TRUE(segments[2].empty());
  for (int i = 7; i < kWordFrames; ++i) {
    ASSERT_EQ(segments[i].size(), 1U) << i;
    EXPECT_GT(test::overlap(segments[i][0].mask, played.truth(i)), 0.85) << i;
  }
}

TEST(AnnotationsTest, LiveTheyHoldFromTheirFrameOn) {
  Played played;
  played.settings.object_points = {{{130, 110}, 10 / kWordFps}};
  const auto segments = played.play(false, true);
  for (int i = 0; i < kWordFrames; ++i) ASSERT_EQ(segments[i].size(), i < 10 ? 0U : 1U) << i;
  EXPECT_GT(test::overlap(segments[15][0].mask, played.truth(15)), 0.85);
}

TEST(AnnotationsTest, ALaterPointOnNothingIsLeftOut) {
  Played played;
  played.settings.object_points = {{{90, 110}}, {{300, 20}, 10 / kWordFps}};
  const auto segments = played.play(true);
  for (int i = 0; i < kWordFrames; ++i) EXPECT_EQ(segments[i].size(), 1U) << i;
}

TEST(AnnotationsTest, APointOnTheTrackedObjectChangesNothing) {
  Played said;
  said.settings.object_points = {{{90, 110}}, {{130, 110}, 10 / kWordFps}};
  Played silent;
  silent.settings.object_points = {{{90, 110}}};
  (void)said.play(true);
  (void)silent.play(true);
  const auto a = said.play(false);
  const auto b = silent.play(false);
  for (int i = 0; i < kWordFrames; ++i) {
    ASSERT_EQ(a[i].size(), 1U);
    EXPECT_EQ(a[i][0].id, b[i][0].id) << i;
    EXPECT_EQ(test::overlap(a[i][0].mask, b[i][0].mask), 1.0) << i;
  }
}

TEST(AnnotationsTest, AClipIsLookedThroughTwiceForLaterNots) {
  const test::BallScene scene{.with_mask = false};
  test::FunctionSource source(scene.info(kWordFps), 12, [&](std::uint64_t i) {
    RgbdFrame out = scene.frame(i, 90 + 4.0 * double(i), 110);
    out.clip_time_s = double(i) / kWordFps;
    return out;
  });
  VisionSettings settings;
  settings.object_points = {{{90, 110}}};
  settings.not_points = {{{20, 20}, 8 / kWordFps}};
  Vision vision(source.info(), settings);
  std::vector<std::uint64_t> progress;
  EXPECT_TRUE(vision.scan(source, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(total, 24U);
    progress.push_back(done);
    return true;
  }));
  ASSERT_EQ(progress.size(), 24U);
  for (std::size_t i = 0; i < progress.size(); ++i) EXPECT_EQ(progress[i], i + 1);
}

}  // namespace
}  // namespace hapticast::server
