// SPDX-License-Identifier: MIT
#include "client/view/force_plot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace hapticast::client {
namespace {

TickReport tickOf(std::size_t tick, double force_N) {
  TickReport report;
  report.time = LocalTime(std::chrono::milliseconds(tick));
  report.force_N = {0.0, 0.0, force_N};
  report.contact = force_N > 0.0;
  return report;
}

TEST(ForceHistory, APointKeepsThePeakOfItsTicks) {
  ForceHistory history;
  for (std::size_t tick = 0; tick < 10; ++tick) history.add(tickOf(tick, tick == 7 ? 2.0 : 0.0));
  ASSERT_EQ(history.points().size(), 2U);
  EXPECT_EQ(history.points()[0].force_N, 0.0);
  EXPECT_FALSE(history.points()[0].contact);
  EXPECT_EQ(history.points()[1].time_s, 0.005);
  EXPECT_EQ(history.points()[1].force_N, 2.0);
  EXPECT_TRUE(history.points()[1].contact);
}

TEST(ForceHistory, OfAnHourKeepsTheLastMinute) {
  ForceHistory history;
  constexpr std::size_t kTicks = 3'600'000;
  for (std::size_t tick = 0; tick < kTicks; ++tick) history.add(tickOf(tick, 1.0));
  EXPECT_EQ(history.points().size(), ForceHistory::kMaxPoints);
  EXPECT_DOUBLE_EQ(history.points().front().time_s, 3600.0 - ForceHistory::kSeconds);
  EXPECT_DOUBLE_EQ(history.points().back().time_s, 3600.0 - 0.005);
}

/// Rows of a plot that have a green pixel; the lines have soft edges.
std::vector<int> greenRows(const cv::Mat& plot) {
  std::vector<int> rows;
  for (int v = 0; v < plot.rows; ++v) {
    for (int u = 48; u < plot.cols; ++u) {
      const auto& pixel = plot.at<cv::Vec3b>(v, u);
      if (pixel[1] < pixel[0] + 60 || pixel[1] < pixel[2] + 60) continue;
      rows.push_back(v);
      break;
    }
  }
  return rows;
}

TEST(ForceHistoryPlot, ItsScaleIncludesAllItsCurves) {
  ForceHistory history;
  for (std::size_t tick = 0; tick < 9000; ++tick) {
    TickReport report = tickOf(tick, 0.5);
    report.static_force_N = {0.0, 0.0, 5.0};
    history.add(report);
  }
  const std::array curves{Curve{&ForcePoint::force_N, {9, 9, 200}},
                          Curve{&ForcePoint::static_force_N, {0, 255, 0}}};
  const cv::Mat plot = drawRecentPlot(history, 1.0, "N", curves, {300, 117});
  const std::vector<int> rows = greenRows(plot);
  ASSERT_FALSE(rows.empty());
  // The scale ends at 8 N; the area is 79 px high, and its upper edge is in row 19.
  EXPECT_NEAR(rows.front(), 19 + 79.0 * 3.0 / 8.0, 2.0);
}

TEST(ForceHistoryPlot, HasAZeroLineATimeAxisAndNames) {
  const cv::Size size(300, 117);
  const std::array unnamed{Curve{&ForcePoint::force_N, {9, 9, 200}}};
  const std::array named{Curve{&ForcePoint::force_N, {9, 9, 200}, "device"}};
  const cv::Mat plain = drawRecentPlot({}, 1.0, "N", unnamed, size);
  const cv::Mat with_name = drawRecentPlot({}, 1.0, "N", named, size);
  EXPECT_GT(cv::norm(plain.rowRange(0, 14), with_name.rowRange(0, 14), cv::NORM_L1), 0.0);
  const auto& ground = plain.at<cv::Vec3b>(60, 60);
  EXPECT_NE(plain.at<cv::Vec3b>(98, 150), ground) << "zero line";
  EXPECT_GT(cv::norm(plain.rowRange(103, 117), cv::Mat(14, 300, CV_8UC3, cv::Scalar(ground)),
                     cv::NORM_L1),
            0.0)
      << "time axis";
}

}  // namespace
}  // namespace hapticast::client
