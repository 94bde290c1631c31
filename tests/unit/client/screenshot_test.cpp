// SPDX-License-Identifier: MIT
#include "client/view/screenshot.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

const cv::Point kInPicture(120, 540);  // near the lower left corner of the video

TickReport touching(double time_s, double force_N) {
  TickReport report;
  report.time = localTime(time_s);
  report.play_time = mediaTime(time_s);
  report.force_N = {0.0, 0.0, force_N};
  report.contact = force_N > 0.0;
  return report;
}

VideoFrame greyPicture(double time_s, int grey) {
  VideoFrame frame{0, 0, mediaTime(time_s), {}};
  cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(grey)), frame.jpeg);
  return frame;
}

class ScreenshotTest : public ::testing::Test {
 protected:
  cv::Mat written() {
    screenshot.finish();
    return cv::imread(file);
  }
  const TempFolder folder;
  const std::string file = (folder / "screenshot.png").string();
  Screenshot screenshot{file};
  UiState ui_state;
};

TEST_F(ScreenshotTest, ShowsTheStrongestTouchEvenIfNoPictureComes) {
  for (const double force_N : {0.0, 0.5, 2.0, 1.0, 0.0}) {
    screenshot.onReport(touching(force_N, force_N));
    EXPECT_TRUE(screenshot.update(ui_state)) << "a screenshot never ends a run";
  }
  EXPECT_EQ(screenshot.moment().force_N.z(), 2.0);
  EXPECT_EQ(written().size(), cv::Size(1280, 720));
}

TEST_F(ScreenshotTest, ShowsTheLastTickWhileNothingWasTouched) {
  for (const double time_s : {1.0, 2.0}) screenshot.onReport(touching(time_s, 0.0));
  EXPECT_EQ(screenshot.moment().time, localTime(2.0));
}

TEST_F(ScreenshotTest, ShowsThePictureOfTheStrongestMoment) {
  for (int i = 0; i < 200; ++i) {  // far more than the buffer holds
    const double time_s = 0.04 * i;
    screenshot.onPicture(greyPicture(time_s, i), Workspace{});
    screenshot.onReport(touching(time_s, i == 100 ? 2.0 : 1.0));
    (void)screenshot.update(ui_state);
  }
  const cv::Mat picture = written();
  ASSERT_FALSE(picture.empty());
  EXPECT_NEAR(picture.at<cv::Vec3b>(kInPicture)[0], 100, 2);
}

TEST_F(ScreenshotTest, APictureOfAnotherSizeThanAnnouncedIsNotShown) {
  Workspace small;
  small.width_px = 320;
  small.height_px = 240;
  screenshot.onPicture(greyPicture(1.0, 200), small);
  screenshot.onReport(touching(1.0, 1.0));
  EXPECT_LT(written().at<cv::Vec3b>(kInPicture)[0], 100);
}

TEST(Screenshot, ReportsAFileThatCannotBeWritten) {
  Screenshot nowhere("/nonexistent/picture.png");
  try {
    nowhere.finish();
    ADD_FAILURE() << "was written";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find("--screenshot /nonexistent/picture.png: "), 0U);
  }
}

}  // namespace
}  // namespace hapticast::client
