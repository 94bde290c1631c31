// SPDX-License-Identifier: MIT
#include "client/view/film.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

constexpr double kFps = 25.0;

/// A run of so many ticks; what is played at a tick comes from `play_s`.
class FilmTest : public ::testing::Test {
 protected:
  template <class PlayTime>
  void run(int ticks, PlayTime play_s) {
    FilmView film(file);
    UiState ui_state;
    ui_state.stream.connected = true;
    ui_state.stream.fps = kFps;
    for (int tick = 0; tick < ticks; ++tick) {
      if (tick % 40 == 0) {
        VideoFrame picture{0, 0, mediaTime(1e-3 * tick), {}};
        cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0.05 * tick)),
                     picture.jpeg);
        film.onPicture(std::move(picture), Workspace{});
      }
      TickReport report;
      report.time = localTime(1e-3 * tick);
      report.play_time = mediaTime(play_s(tick));
      film.onReport(report);
      if (tick % 10 == 0) {
        EXPECT_TRUE(film.update(ui_state)) << "a film never ends a run";
      }
    }
    film.finish();
  }
  /// The pictures of the film, each as grey as its video.
  [[nodiscard]] std::vector<int> greys() const {
    cv::VideoCapture capture(file);
    EXPECT_NEAR(capture.get(cv::CAP_PROP_FPS), kFps, 1e-6);
    std::vector<int> greys;
    for (cv::Mat picture; capture.read(picture);) {
      EXPECT_EQ(picture.size(), cv::Size(1280, 720));
      greys.push_back(picture.at<cv::Vec3b>(500, 760)[1]);
    }
    return greys;
  }
  const TempFolder folder;
  std::string file = (folder / "film.mp4").string();
};

TEST_F(FilmTest, HasOnePictureForEachOfTheVideo) {
  run(1000, [](int tick) { return 1e-3 * tick; });
  const std::vector<int> greys = this->greys();
  EXPECT_NEAR(static_cast<double>(greys.size()), kFps, 1.0);
  for (std::size_t i = 0; i < greys.size(); ++i)
    EXPECT_NEAR(greys[i], 2.0 * static_cast<double>(i), 5.0) << i;
}

TEST_F(FilmTest, GoesOnWhilePlayTimeStandsOrJumps) {
  run(1000, [](int tick) { return tick < 250 ? 1e-3 * tick : tick < 750 ? 0.25 : 100.0; });
  EXPECT_NEAR(static_cast<double>(greys().size()), kFps, 1.0);
}

TEST_F(FilmTest, FollowsPlayTimeThatIsSlewed) {
  run(1000, [](int tick) { return 1.02e-3 * tick; });
  EXPECT_NEAR(static_cast<double>(greys().size()), 1.02 * kFps, 1.0);
}

TEST_F(FilmTest, ReportsAFullDisk) {
  file = "/dev/full";
  try {
    run(200, [](int tick) { return 1e-3 * tick; });
    ADD_FAILURE() << "a film on a full disk";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              "--film /dev/full: not written completely; is the disk full?");
  }
}

TEST_F(FilmTest, WithoutAPictureItReportsSo) {
  FilmView film(file);
  film.onReport({});
  try {
    film.finish();
    ADD_FAILURE() << "a film of nothing";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              "--film " + file + ": no picture arrived, so the film is empty");
  }
}

}  // namespace
}  // namespace hapticast::client
