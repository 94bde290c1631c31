// SPDX-License-Identifier: MIT
#include "client/view/overlay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "client/view/force_plot.hpp"
#include "client/view/painter.hpp"

namespace hapticast::client {
namespace {

constexpr int kHead_px = 90;  // text and room for the cone, above the video

TickReport pressing(int tick, double force_N) {
  TickReport report;
  report.tick = static_cast<std::uint64_t>(tick);
  report.time = localTime(100.0 + 1e-3 * tick);
  report.hip_mm = {40.0, 20.0, 10.0};
  report.force_N = {0.0, 0.0, force_N};
  report.static_force_N = report.force_N;
  report.contact = force_N > 0.0;
  return report;
}

/// The smallest rectangle that holds all pixels in which two pictures differ.
cv::Rect differing(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference, grey;
  cv::absdiff(a, b, difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  return cv::boundingRect(grey > 0);
}

TEST(Overlay, ConeStandsAtTheHipAndTheArrowGrowsWithTheForce) {
  const Workspace workspace;
  const cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  const auto drawn = [&](double force_N) {
    return drawOverlay(picture, pressing(0, force_N), workspace, ForceHistory());
  };
  const cv::Mat none = drawn(0.0);
  EXPECT_EQ(none.cols, 960);
  // (40, 20) mm is (480, 160) px of 640 x 480; the video begins below the head.
  const cv::Vec3b tip = none.at<cv::Vec3b>(kHead_px + 240, 720);
  EXPECT_EQ(tip, cv::Vec3b(255, 255, 255));

  const cv::Rect below_text(0, 26, 960, kHead_px + 720 - 26);
  const cv::Rect one = differing(none(below_text), drawn(1.0)(below_text));
  const cv::Rect two = differing(none(below_text), drawn(2.0)(below_text));
  EXPECT_GT(two.area(), one.area());
  EXPECT_GT(one.area(), 0);
}

TEST(Overlay, ANewtonHasTheSameLengthInEveryDirection) {
  const ScenePlace place({}, {0.0, 0.0}, {960.0, 720.0});
  const double wanted_px = place.arrow({1.0, 0.0, 0.0}).norm();
  EXPECT_NEAR(wanted_px, 86.4, 1e-9);
  for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.1) {
    for (double height = -1.0; height <= 1.0; height += 0.05) {
      const double flat = std::sqrt(std::max(0.0, 1.0 - height * height));
      const Vec3 force_N(flat * std::cos(azimuth), flat * std::sin(azimuth), height);
      EXPECT_NEAR(place.arrow(force_N).norm(), wanted_px, 0.05 * wanted_px) << force_N.transpose();
    }
  }
  const Vec3 along_view(-0.35, -0.75, 1.0);  // its projection is a point
  EXPECT_NEAR(place.arrow(along_view.normalized()).norm(), wanted_px, 0.05 * wanted_px);
  EXPECT_EQ(place.arrow(Vec3::Zero()), Vec2(0.0, 0.0));
}

TEST(Overlay, AForceKeepsTheDirectionOfItsProjection) {
  const ScenePlace place({}, {0.0, 0.0}, {960.0, 720.0});
  const Vec2 up = place.arrow({0.0, 0.6, 0.8}).normalized();
  EXPECT_LT((up - Vec2(0.28, -1.2).normalized()).norm(), 1e-9);
}

TEST(Overlay, ForcesBeforeTheChainAreScaledToTheRenderedShare) {
  TickReport report = pressing(0, 4.0);
  EXPECT_DOUBLE_EQ(renderedShare(report), 1.0);
  report.force_N = {0.0, 0.0, 1.0};
  EXPECT_DOUBLE_EQ(renderedShare(report), 0.25);
  report.force_N = Vec3::Zero();
  EXPECT_EQ(renderedShare(report), 0.0);
}

TEST(Overlay, WithoutAForceAtTheDeviceThereIsNoArrow) {
  TickReport report = pressing(0, 4.0);
  report.dynamic_force_N = {1.0, 0.0, 0.0};
  report.force_N = Vec3::Zero();
  TickReport none = report;
  none.static_force_N = none.dynamic_force_N = Vec3::Zero();
  const ForceHistory history;
  const cv::Rect below_text(0, 46, 960, kHead_px + 720 - 46);
  EXPECT_EQ(differing(drawOverlay({}, report, {}, history)(below_text),
                      drawOverlay({}, none, {}, history)(below_text))
                .area(),
            0);
}

TEST(Overlay, BeforeContactALineShowsTheHeightAboveTheSurface) {
  TickReport report = pressing(0, 0.0);
  const cv::Mat without = drawOverlay({}, report, {}, ForceHistory());
  report.object_present = report.over_object = true;
  const auto measureLine_px = [&](double height_mm) {
    report.height_at_hip_mm = height_mm;
    const cv::Rect below_text(0, 46, 960, kHead_px + 720 - 46);
    return differing(without(below_text), drawOverlay({}, report, {}, ForceHistory())(below_text))
        .height;
  };
  EXPECT_GT(measureLine_px(2.0), measureLine_px(7.0));
  EXPECT_GT(measureLine_px(7.0), 0);
  EXPECT_EQ(measureLine_px(10.5), 0) << "below the surface";
}

TEST(Overlay, PlotKeepsPeaksBetweenItsPoints) {
  const Workspace workspace;
  ForceHistory flat, peak;
  for (int tick = 0; tick < 1000; ++tick) {
    flat.add(pressing(tick, 0.0));
    peak.add(pressing(tick, tick == 503 ? 2.0 : 0.0));  // one tick only
  }
  const cv::Mat a = drawOverlay({}, pressing(999, 0.0), workspace, flat);
  const cv::Mat b = drawOverlay({}, pressing(999, 0.0), workspace, peak);
  EXPECT_GT(differing(a, b).height, 100);
}

TEST(Overlay, TheAxisOfThePlotShowsTheTimeOfTheRun) {
  ForceHistory begin, later;
  for (int tick = 0; tick < 5000; ++tick) {
    begin.add(pressing(tick, 1.0));
    later.add(pressing(tick + 60'000, 1.0));
  }
  const cv::Size size(960, 260);
  const double mark_s = 0.0;  // before both
  const cv::Rect differs =
      differing(drawForcePlot(begin, mark_s, size), drawForcePlot(later, mark_s, size));
  EXPECT_GT(differs.area(), 0);
  EXPECT_GT(differs.y, 220) << "the labels alone";
}

TEST(Overlay, AHipBesideThePictureIsShownAtItsEdge) {
  TickReport report = pressing(0, 0.0);
  report.hip_mm = {0.0, 63.0, 10.0};  // 3 mm above the upper edge
  const cv::Mat drawn = drawOverlay({}, report, Workspace{}, ForceHistory());
  EXPECT_EQ(drawn.at<cv::Vec3b>(kHead_px, 480), cv::Vec3b(255, 255, 255));
}

TEST(Overlay, SurvivesOddReports) {
  TickReport report = pressing(0, 0.0);
  report.hip_mm = {1e9, -1e9, 0.0};
  EXPECT_FALSE(drawOverlay({}, report, Workspace{}, ForceHistory()).empty());  // HIP far outside
}

}  // namespace
}  // namespace hapticast::client
