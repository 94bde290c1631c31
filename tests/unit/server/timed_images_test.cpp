// SPDX-License-Identifier: MIT
// Folders whose images have times: in TUM's lists, or in their names. Colour n is evenly n bright,
// depth n is 1000 + n mm (in TUM's units of 0.2 mm: 5000 + 5 n).
#include "server/source/folder/timed_images.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class TimedImages : public testing::Test {
 protected:
  using Stamp = std::function<std::string(int)>;

  void writeColor(const std::string& name, int i) const {
    folder.write("rgb/" + name + ".png", cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(i)));
  }
  void writeDepth(const std::string& name, int i, int value) const {
    folder.write("depth/" + name + ".png", cv::Mat(24, 32, CV_16UC1, cv::Scalar(value + i)));
  }
  /// Writes images named by their time stamps, without those dropped.
  void writeStamped(int frames, const std::set<int>& no_color, const std::set<int>& no_depth,
                    const Stamp& color, const Stamp& depth) const {
    for (int i = 0; i < frames; ++i) {
      if (!no_color.contains(i)) writeColor(color(i), i);
      if (!no_depth.contains(i)) writeDepth(depth(i), i, 1000);
    }
  }
  /// Writes TUM's lists with the lines in this order, and the images.
  void writeLists(const std::vector<int>& colors, const std::vector<int>& depths,
                  const Stamp& stamp) const {
    std::string rgb;
    std::string depth;
    for (const int i : colors) {
      writeColor(std::to_string(i), i);
      rgb += stamp(i) + fmt::format(" rgb/{}.png\n", i);
    }
    for (const int i : depths) {
      writeDepth(std::to_string(i), 5 * i, 5000);
      depth += stamp(i) + fmt::format(" depth/{}.png\n", i);
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
  }
  [[nodiscard]] ImageSequence open() const { return ImageSequence(folder.string(), 0.0); }
  /// Reads all frames. Returns the numbers of their colours. Each must have its own depth.
  [[nodiscard]] static std::vector<int> readAll(RgbdSource& source) {
    std::vector<int> colors;
    while (const auto frame = source.read()) {
      colors.push_back(frame->color.at<cv::Vec3b>(0, 0)[0]);
      EXPECT_NEAR(frame->depth.at<float>(0, 0), 1000.0F + static_cast<float>(colors.back()), 1e-3F);
    }
    return colors;
  }
  SourceFolder folder;
};

std::string nameSeconds(int i) { return fmt::format("{:.6f}", 1305031102.175304 + i / 30.0); }
std::string roundedSeconds(int i) { return fmt::format("{:g}", 1305031102.175304 + i / 30.0); }
/// As Python writes a float: in the order of names, 5.475 comes before 5.15625.
std::string shortSeconds(int i) { return fmt::format("{}", 5.05 + i * 0.10625); }
std::string nameNanoseconds(int i) {
  return std::to_string(1403636579763555584LL + i * 50000000LL);
}
std::string nameMicroseconds(int i) { return std::to_string(1403636579763555LL + i * 50000LL); }
std::string nameMilliseconds(int i) { return std::to_string(1403636579763LL + i * 50LL); }
std::string tenDigits(int i) { return fmt::format("{:010}", i); }

TEST_F(TimedImages, TumListsPlayInTheOrderOfTimes) {
  writeLists({0, 1, 3, 2, 5, 4}, {5, 4, 3, 2, 1, 0}, nameSeconds);
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_NEAR(source.info().fps, 30.0, 0.01);
  EXPECT_EQ(log.count(), 2) << log.text();
  EXPECT_THAT(log.text(),
              AllOf(HasSubstr("rgb.txt: line 4 has an earlier time than the line before"),
                    HasSubstr("depth.txt: line 2 has an earlier time")));
}

TEST_F(TimedImages, RoundedTimesOfTumListsPairLinesByOrderWithAWarning) {
  writeLists({0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}, roundedSeconds);
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(source.info().fps, 25.0);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), AllOf(HasSubstr("rgb.txt: many lines share one time"),
                                HasSubstr("by their order"), HasSubstr("%.6f")));
}

TEST_F(TimedImages, RoundedTimesOfListsThatDifferAreRefused) {
  writeLists({0, 1, 2, 3, 4, 5}, {0, 1, 3, 4, 5}, roundedSeconds);
  EXPECT_THAT(errorOf([&] { (void)open(); }),
              AllOf(HasSubstr("rgb.txt: many lines share one time"), HasSubstr("%.6f")));
}

TEST_F(TimedImages, AnImageThatIsListedTwiceIsUsedOnce) {
  std::vector<int> colors(20);
  std::iota(colors.begin(), colors.end(), 0);
  std::vector<int> twice = colors;
  twice.insert(twice.begin() + 7, 7);
  writeLists(twice, colors, nameSeconds);
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), colors);
  EXPECT_EQ(log.count(), 0) << log.text();
}

TEST_F(TimedImages, StampsInNamesPairImagesOfOtherNumbers) {
  for (const auto& stamp : {nameSeconds, nameNanoseconds, nameMicroseconds, nameMilliseconds}) {
    SCOPED_TRACE(stamp(0));
    std::filesystem::remove_all(folder / "rgb");
    std::filesystem::remove_all(folder / "depth");
    writeStamped(12, {3, 4}, {8}, stamp, stamp);
    const LogLines log;
    ImageSequence source = open();
    EXPECT_EQ(source.info().frame_count, 10U) << "a colour image without depth is a gap";
    EXPECT_NEAR(source.info().fps, stamp == nameSeconds ? 30.0 : 20.0, 0.01);
    EXPECT_EQ(log.count(), 1) << log.text();
    EXPECT_THAT(log.text(),
                HasSubstr("1 colour images have no depth, and 2 depth images no colour"));
    EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 5, 6, 7, 9, 10, 11}));
    EXPECT_EQ(log.count(), 2) << log.text();
  }
}

TEST_F(TimedImages, StampsInNamesShowDropsInAsManyImages) {
  writeStamped(12, {3}, {8}, nameNanoseconds, [](int i) { return "depth_" + nameNanoseconds(i); });
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 4, 5, 6, 7, 9, 10, 11}));
  EXPECT_THAT(log.text(), HasSubstr("1 colour images have no depth, and 1 depth images no colour"));
}

TEST_F(TimedImages, AsManyStampedImagesInStepPairAsBefore) {
  // Another clock for the depth: 70 s later.
  writeStamped(6, {}, {}, nameNanoseconds, [](int i) { return nameNanoseconds(i + 1400); });
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(source.info().fps, 25.0);
  EXPECT_EQ(log.count(), 0) << log.text();
}

TEST_F(TimedImages, ShortenedSecondsPlayInTheOrderOfTimes) {
  writeStamped(8, {}, {}, shortSeconds, shortSeconds);
  ImageSequence source = open();
  EXPECT_EQ(readAll(source), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST_F(TimedImages, NumbersOfTenDigitsPairToo) {
  writeStamped(8, {}, {0, 1, 5}, tenDigits, tenDigits);
  const LogLines log;
  ImageSequence source = open();
  EXPECT_EQ(source.info().fps, 25.0);
  EXPECT_EQ(readAll(source), (std::vector<int>{2, 3, 4, 6, 7}));
  EXPECT_THAT(log.text(), HasSubstr("3 colour images have no depth, and 0 depth images no colour"));
}

TEST_F(TimedImages, StampsOfTwoClocksWithoutPartnersAreRefused) {
  writeStamped(6, {}, {2}, nameNanoseconds, [](int i) { return nameNanoseconds(i + 1400); });
  EXPECT_THAT(errorOf([&] { (void)open(); }), HasSubstr("5 images, but there are 6 colour images"));
}

TEST_F(TimedImages, NoPairIsWrongWhateverImagesAreDropped) {
  std::mt19937 random(11);
  for (int round = 0; round < 6; ++round) {
    std::filesystem::remove_all(folder / "rgb");
    std::filesystem::remove_all(folder / "depth");
    std::bernoulli_distribution lost(0.05 * round);
    std::set<int> no_color;
    std::set<int> no_depth;
    std::vector<int> both;
    constexpr int kFrames = 60;
    for (int i = 0; i < kFrames; ++i) {
      if (lost(random)) no_color.insert(i);
      if (lost(random)) no_depth.insert(i);
      if (!no_color.contains(i) && !no_depth.contains(i)) both.push_back(i);
    }
    writeStamped(kFrames, no_color, no_depth, nameSeconds, nameSeconds);
    ImageSequence source = open();
    EXPECT_EQ(readAll(source), both) << round;
  }
}

TEST_F(TimedImages, ImagesOnTheirSideAreToBeTurned) {
  folder.write("rgb/0.png", cv::Mat(32, 24, CV_8UC3, cv::Scalar::all(9)));
  writeDepth("0", 0, 1000);
  EXPECT_THAT(errorOf([&] { (void)open(); }),
              HasSubstr("0.png: is 32x24, but the clip's colour is 24x32; turn it by 90 degrees "
                        "(ffmpeg -i FILE -vf transpose=1 OUT)"));
}

}  // namespace
}  // namespace hapticast::server
