// SPDX-License-Identifier: MIT
// The forms of --source.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/videoio.hpp>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(OpenSource, EverySyntheticScene) {
  for (const char* name : {"bounce", "approach", "tumble", "still"}) {
    const auto source = openSource(std::string("synthetic:") + name, 0.0);
    EXPECT_EQ(source->info().name, std::string("synthetic:") + name);
    EXPECT_EQ(source->info().fps, 25.0);
    EXPECT_TRUE(source->read());
  }
  EXPECT_EQ(openSource("synthetic:still", 100.0)->info().fps, 100.0);
  EXPECT_NE(errorOf([] { (void)openSource("synthetic:still", 0.0, true); }).find("--to-and-fro"),
            std::string::npos);
}

TEST(OpenSource, AnUnknownSceneListsThoseThereAre) {
  EXPECT_THAT(openError("synthetic:jump"),
              AllOf(HasSubstr("synthetic:jump"), HasSubstr("bounce, approach, tumble, still")));
  EXPECT_THAT(openError("synthetic:"), HasSubstr("bounce"));
}

TEST(OpenSource, TheFrameRateIsChecked) {
  for (const double fps : {0.5, -1.0, 241.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THAT(openError("synthetic:still", fps), HasSubstr("allowed is 1 to 240"));
  }
}

TEST(OpenSource, APathWithNeither) {
  EXPECT_THAT(
      openError("/no/such/place"),
      AllOf(HasSubstr("/no/such/place: no such file or folder"), HasSubstr("synthetic:NAME")));
  EXPECT_THAT(openError(""), HasSubstr("(empty source)"));
  const SourceFolder folder;
  folder.write("video.mp4", std::string("x"));
  EXPECT_THAT(openError((folder / "video.mp4").string()),
              AllOf(HasSubstr("is a single file"), HasSubstr("COLOR,DEPTH")));
  EXPECT_THAT(openError(folder.string()), HasSubstr("no folder rgb/"));
}

TEST(OpenSource, AddressesThatAreNoStreamsAreReported) {
  for (const char* spec : {"ftp://me:secret@h/c.mp4", "file://h/c.mp4", "rtmp://h/1"}) {
    EXPECT_THAT(openError(spec), AllOf(HasSubstr(": is an address that the server does not read"),
                                       HasSubstr("srt://"), Not(HasSubstr("secret"))));
  }
  EXPECT_THAT(openError("http://h/c.mp4,http://me:secret@h/d.mp4"),
              AllOf(HasSubstr("two streams have no common clock"), Not(HasSubstr("secret"))));
  EXPECT_THAT(errorOf([] { (void)openSource("rtsp://h/1", 0.0, true); }),
              HasSubstr("--to-and-fro: a live stream has one direction"));
}

TEST(OpenSource, ArchivesAreReported) {
  const SourceFolder folder;
  folder.write("clip.zip", std::string("x"));
  EXPECT_THAT(openError((folder / "clip.zip").string()),
              HasSubstr("clip.zip: is an archive; unpack it"));
}

TEST(OpenSource, APairWithAPartMissing) {
  const SourceFolder folder;
  folder.write("c.mp4", std::string("x"));
  const std::string color = (folder / "c.mp4").string();
  EXPECT_THAT(openError(color + ","), HasSubstr("one of the two videos is missing"));
  EXPECT_THAT(openError("," + color), HasSubstr("one of the two videos is missing"));
  EXPECT_THAT(openError("none.mp4," + color), HasSubstr("none.mp4: no such file"));
  EXPECT_THAT(openError(color + ",none.mp4"), HasSubstr(".mp4: "));
}

TEST(OpenSource, FilesWithCommasInTheirNames) {
  const SourceFolder folder;
  const auto write = [&](const std::string& name) {
    std::string file = (folder / name).string();
    cv::VideoWriter writer(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0, {32, 32});
    for (int i = 0; i < 3; ++i) writer.write(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(100)));
    return file;
  };
  const std::string color = write("a,b.avi");
  const std::string depth = write("c,d.avi");
  EXPECT_EQ(openSource(color + "," + depth, 0.0)->info().name, "a,b.avi") << "no path";
}

TEST(OpenSource, AFolderOfImages) {
  const SourceFolder folder;
  folder.write("rgb/1.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(9)));
  folder.write("depth/1.png", cv::Mat(24, 32, CV_16UC1, cv::Scalar(700)));
  const auto source = openSource(folder.string(), 50.0);
  EXPECT_EQ(source->info().frame_count, 1U);
  EXPECT_EQ(source->info().fps, 50.0);
}

}  // namespace
}  // namespace hapticast::server
