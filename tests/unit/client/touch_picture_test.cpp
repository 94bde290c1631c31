// SPDX-License-Identifier: MIT
#include "client/view/touch_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "client/view/force_plot.hpp"
#include "client/view/painter.hpp"

namespace hapticast::client {
namespace {

const cv::Rect kPictureRoom(0, 44, 900, 506);

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

/// The place of the video in the picture of a touch.
cv::Mat drawnScene(const cv::Mat& picture, const TickReport& report) {
  const cv::Mat plot(kTouchPlot_px, CV_8UC3, kGroundColor);
  return drawTouchPicture(picture, report, {}, "", plot)(kPictureRoom).clone();
}

/// The smallest rectangle that holds all pixels in which two pictures differ.
cv::Rect differing(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference, grey;
  cv::absdiff(a, b, difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  return cv::boundingRect(grey > 0);
}

TEST(TouchPicture, ConeStandsAtTheHipAndTheArrowGrowsWithTheForce) {
  const cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  const auto drawn = [&](double force_N) {
    TickReport report = pressing(0, force_N);
    report.hip_mm.z() = 0.0;
    return drawnScene(picture, report);
  };
  const cv::Mat none = drawn(0.0);
  // (40, 20) mm is (480, 160) px of 640 x 480, which is 506 px high here.
  const ScenePlace place({}, {0.0, 0.0}, {900.0, 506.0});
  const Vec2 tip = place.fromNominal({40.0, 20.0});
  EXPECT_EQ(none.at<cv::Vec3b>(static_cast<int>(tip.y()), static_cast<int>(tip.x())),
            cv::Vec3b(255, 255, 255));
  const cv::Rect one = differing(none, drawn(1.0));
  const cv::Rect two = differing(none, drawn(2.0));
  EXPECT_GT(two.area(), one.area());
  EXPECT_GT(one.area(), 0);
}

/// The distance from the tip to the farthest pixel of the arrow of the force.
double drawnLength_px(const ScenePlace& place, const Vec3& force_N) {
  TickReport report = pressing(0, 0.0);
  report.hip_mm = Vec3::Zero();
  report.force_N = force_N;
  cv::Mat image(720, 960, CV_8UC3, kGroundColor);
  drawTouch(image, place, report);
  cv::Mat arrow;
  cv::inRange(image, kForceColor, kForceColor, arrow);
  std::vector<cv::Point> pixels;
  cv::findNonZero(arrow, pixels);
  const Vec2 tip = place.fromNominal(Vec2::Zero());
  double length_px = 0.0;
  for (const cv::Point& at : pixels)
    length_px = std::max(length_px, (Vec2(at.x + 0.5, at.y + 0.5) - tip).norm());
  return length_px;
}

TEST(TouchPicture, TheDrawnArrowHasItsLengthInRandomDirections) {
  const ScenePlace place({}, {0.0, 0.0}, {960.0, 720.0});
  const double pixels_per_N = place.arrow({1.0, 0.0, 0.0}).norm();
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> size_N(1.0, 3.3);
  const Vec3 along_view(-0.35, -0.75, 1.0);
  for (int i = 0; i < 400; ++i) {
    Vec3 direction(normal(random), normal(random), normal(random));
    if (i % 4 == 0) direction = along_view.normalized() + 0.05 * direction;
    const Vec3 force_N = size_N(random) * direction.normalized();
    const double wanted_px = pixels_per_N * force_N.norm();
    EXPECT_NEAR(drawnLength_px(place, force_N), wanted_px, 0.05 * wanted_px)
        << i << ": " << force_N.transpose();
  }
}

TEST(TouchPicture, ANewtonHasTheSameLengthInEveryDirection) {
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

TEST(TouchPicture, AForceKeepsTheDirectionOfItsProjection) {
  const ScenePlace place({}, {0.0, 0.0}, {960.0, 720.0});
  const Vec2 up = place.arrow({0.0, 0.6, 0.8}).normalized();
  EXPECT_LT((up - Vec2(0.28, -1.2).normalized()).norm(), 1e-9);
}

TEST(TouchPicture, ForcesBeforeTheChainAreScaledToTheRenderedShare) {
  TickReport report = pressing(0, 4.0);
  EXPECT_DOUBLE_EQ(renderedShare(report), 1.0);
  report.force_N = {0.0, 0.0, 1.0};
  EXPECT_DOUBLE_EQ(renderedShare(report), 0.25);
  report.force_N = Vec3::Zero();
  EXPECT_EQ(renderedShare(report), 0.0);
}

TEST(TouchPicture, WithoutAForceAtTheDeviceThereIsNoArrow) {
  TickReport report = pressing(0, 4.0);
  report.dynamic_force_N = {1.0, 0.0, 0.0};
  report.force_N = Vec3::Zero();
  TickReport none = report;
  none.static_force_N = none.dynamic_force_N = Vec3::Zero();
  EXPECT_EQ(differing(drawnScene({}, report), drawnScene({}, none)).area(), 0);
}

TEST(TouchPicture, BeforeContactALineLeadsToTheSpotThatTheHipWouldTouch) {
  TickReport report = pressing(0, 0.0);
  report.object_present = report.over_object = true;
  const auto findLine = [&](double height_mm) {
    report.height_at_hip_mm = height_mm;
    cv::Mat line;
    const cv::Scalar near(16, 16, 16);  // of lines with soft edges
    cv::inRange(drawnScene({}, report), kGapColor - near, kGapColor + near, line);
    return cv::boundingRect(line);
  };
  const ScenePlace place({}, {0.0, 0.0}, {900.0, 506.0});
  const Vec2 spot = place.fromNominal(report.hip_mm.head<2>());
  for (const double height_mm : {2.0, 7.0}) {
    const cv::Rect line = findLine(height_mm);
    EXPECT_NEAR(line.y + line.height, spot.y(), 6.0) << "its lower end, " << height_mm;
  }
  EXPECT_EQ(findLine(10.5).height, 0) << "below the surface";
}

TEST(TouchPicture, PlotKeepsPeaksBetweenItsPoints) {
  ForceHistory flat, peak;
  for (int tick = 0; tick < 1000; ++tick) {
    flat.add(pressing(tick, 0.0));
    peak.add(pressing(tick, tick == 503 ? 2.0 : 0.0));  // one tick only
  }
  const cv::Mat a = drawForcePlot(flat, 0.999, kTouchPlot_px);
  const cv::Mat b = drawForcePlot(peak, 0.999, kTouchPlot_px);
  EXPECT_GT(differing(a, b).height, 90);
}

TEST(TouchPicture, TheAxisOfThePlotShowsTheTimeOfTheRun) {
  ForceHistory begin, later;
  for (int tick = 0; tick < 5000; ++tick) {
    begin.add(pressing(tick, 1.0));
    later.add(pressing(tick + 60'000, 1.0));
  }
  const double mark_s = 0.0;  // before both
  const cv::Rect differs = differing(drawForcePlot(begin, mark_s, kTouchPlot_px),
                                     drawForcePlot(later, mark_s, kTouchPlot_px));
  EXPECT_GT(differs.area(), 0);
  EXPECT_GT(differs.y, 132) << "the labels alone";
}

TEST(TouchPicture, AHipBesideThePictureIsShownAtItsEdge) {
  TickReport report = pressing(0, 0.0);
  report.hip_mm = {0.0, 63.0, 0.0};  // 3 mm above the upper edge
  EXPECT_EQ(drawnScene({}, report).at<cv::Vec3b>(0, 450), cv::Vec3b(255, 255, 255));
}

TEST(TouchPicture, SurvivesOddReports) {
  TickReport report = pressing(0, 0.0);
  report.hip_mm = {1e9, -1e9, 0.0};  // far outside
  EXPECT_FALSE(drawnScene({}, report).empty());
}

TEST(TouchPicture, AnyPictureFits) {
  const cv::Mat plot(kTouchPlot_px, CV_8UC3, kGroundColor);
  for (const cv::Size& size : {cv::Size(640, 480), cv::Size(1920, 1080), cv::Size(424, 512)}) {
    Workspace workspace;
    workspace.width_px = size.width;
    workspace.height_px = size.height;
    const cv::Mat picture(size, CV_8UC3, cv::Scalar::all(9));
    EXPECT_EQ(drawTouchPicture(picture, {}, workspace, "", plot).size(), kTouchPicture_px);
  }
}

TEST(TouchPicture, TheLegendEndsBeforeTheRightEdge) {
  const cv::Mat plot(kTouchPlot_px, CV_8UC3, kGroundColor);
  const cv::Mat edge = drawTouchPicture({}, {}, {}, "", plot).colRange(1270, 1280).clone();
  const cv::Mat ground(edge.size(), CV_8UC3, kGroundColor);
  EXPECT_EQ(differing(edge, ground).area(), 0);
}

TEST(TouchPicture, EachMarkHasAColourAndATextOfItsOwn) {
  for (const Legend& mark : kLegend) {
    const auto same = std::count_if(kLegend.begin(), kLegend.end(), [&](const Legend& other) {
      return other.color == mark.color || std::string(other.text) == mark.text;
    });
    EXPECT_EQ(same, 1) << mark.text;
  }
}

}  // namespace
}  // namespace hapticast::client
