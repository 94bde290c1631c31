// SPDX-License-Identifier: MIT
// hapticast-media.so: films, PNG files, and what a user reads if the module is missing.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "client/view/picture.hpp"
#include "common/media/load_media_module.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

const cv::Size kFilm_px(64, 48);

std::string findError(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

/// Files of a process cannot grow beyond `most_bytes` while this object lives.
class UntrustedClientsFileLimit {
 public:
  explicit UntrustedClientsFileLimit(rlim_t most_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{most_bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~UntrustedClientsFileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  UntrustedClientsFileLimit(const UntrustedClientsFileLimit&) = delete;
  UntrustedClientsFileLimit& operator=(const UntrustedClientsFileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

class MediaModuleTest : public ::testing::Test {
 protected:
  /// Writes `pictures` pictures, picture i with the grey i, and completes the film.
  void makeFilm(double fps, int pictures) const {
    const auto film = module.openFilm(file, {kFilm_px.width, kFilm_px.height, fps});
    for (int i = 0; i < pictures; ++i)
      film->write(viewPixels(cv::Mat(kFilm_px, CV_8UC3, cv::Scalar::all(i))));
    film->close();
  }
  const TempFolder folder;
  std::string file = (folder / "film.mp4").string();
  const MediaModule& module = loadMediaModule();
};

TEST_F(MediaModuleTest, EachPictureArrivesAtTheRateOfTheStream) {
  for (const double fps : {1.0, 12.5, 25.0, 29.97, 30000.0 / 1001.0, 240.0}) {
    constexpr int kPictures = 100;
    makeFilm(fps, kPictures);
    cv::VideoCapture film(file);
    EXPECT_NEAR(film.get(cv::CAP_PROP_FPS), fps, 1e-6);
    EXPECT_EQ(film.get(cv::CAP_PROP_FRAME_COUNT), kPictures) << fps;
    int count = 0;
    for (cv::Mat picture; film.read(picture); ++count) {
      ASSERT_EQ(picture.size(), kFilm_px);
      EXPECT_NEAR(picture.at<cv::Vec3b>(24, 32)[1], count, 4) << fps;
    }
    EXPECT_EQ(count, kPictures) << fps;
  }
}

TEST_F(MediaModuleTest, AFilmKeepsItsColors) {
  const cv::Scalar blue(220, 90, 30);
  const auto film = module.openFilm(file, {kFilm_px.width, kFilm_px.height, 25.0});
  film->write(viewPixels(cv::Mat(kFilm_px, CV_8UC3, blue)));
  film->close();
  cv::Mat picture;
  ASSERT_TRUE(cv::VideoCapture(file).read(picture));
  EXPECT_LT(cv::norm(picture.at<cv::Vec3b>(24, 32), cv::Vec3b(220, 90, 30)), 6.0);
}

TEST_F(MediaModuleTest, AFilmThatIsNotWrittenCompletelyIsRemoved) {
  {
    const UntrustedClientsFileLimit limit(1000);
    EXPECT_EQ(findError([this] { makeFilm(25.0, 100); }),
              file + ": not written completely (File too large)");
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  {
    const auto film = module.openFilm(file, {kFilm_px.width, kFilm_px.height, 25.0});
    EXPECT_TRUE(std::filesystem::exists(file));
  }
  EXPECT_FALSE(std::filesystem::exists(file)) << "it was never closed";
}

TEST_F(MediaModuleTest, AFilmReportsAFileThatCannotBeWritten) {
  file = "/dev/full";
  EXPECT_EQ(findError([this] { makeFilm(25.0, 100); }),
            "/dev/full: not written completely; is the disk full?");
  EXPECT_TRUE(std::filesystem::exists(file)) << "it removes files only";
  file = "/nonexistent/film.mp4";
  EXPECT_EQ(findError([this] { makeFilm(25.0, 1); }),
            "/nonexistent/film.mp4: cannot be written (No such file or directory)");
}

TEST_F(MediaModuleTest, APngFileHasThePixels) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(37, 21), cv::Size(1280, 720)}) {
    cv::Mat whole(size + cv::Size(5, 0), CV_8UC3);
    cv::randu(whole, 0, 256);
    const cv::Mat picture = whole.colRange(2, 2 + size.width);  // not continuous
    const cv::Mat read = cv::imdecode(module.encodePng(viewPixels(picture)), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(read.size(), size);
    ASSERT_EQ(read.type(), CV_8UC3);
    EXPECT_EQ(cv::norm(read, picture, cv::NORM_INF), 0.0) << size;
  }
}

TEST(LoadMediaModule, AMissingModuleIsOneLine) {
  const TempFolder folder;
  const std::string missing = (folder / "hapticast-media.so").string();
  EXPECT_EQ(findError([&] { (void)loadMediaModule(missing); }),
            missing + ": no such file; it belongs into the folder of hapticast-client");
}

TEST(LoadMediaModule, AFileThatIsNoModuleIsOneLine) {
  const TempFolder folder;
  const std::string text = folder.write("hapticast-media.so", "no library");
  const std::string error = findError([&] { (void)loadMediaModule(text); });
  EXPECT_EQ(error.find(text + ": cannot be opened: "), 0U) << error;
  EXPECT_NE(error.find("; install hapticast-client again"), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  Dl_info libm{};
  ASSERT_NE(dladdr(reinterpret_cast<void*>(static_cast<double (*)(double)>(&std::erf)), &libm), 0);
  const std::string other = libm.dli_fname;
  EXPECT_EQ(findError([&] { (void)loadMediaModule(other); }),
            other +
                ": is not the module of this version; install it together with "
                "hapticast-client");
}

}  // namespace
}  // namespace hapticast::client
