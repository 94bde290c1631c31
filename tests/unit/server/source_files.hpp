// SPDX-License-Identifier: MIT
// Shared by the tests of sources: a folder of their own, images in it, the log's warnings, the
// text of an error.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "server/source/rgbd_source.hpp"
#include "tests/support/installed.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {

/// A folder of this test's own, of images too.
class SourceFolder : public TempFolder {
 public:
  using TempFolder::write;
  void write(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories((*this / name).parent_path());
    ASSERT_TRUE(cv::imwrite((*this / name).string(), image));
  }
  /// Runs ffmpeg in the folder.
  void ffmpeg(const std::string& arguments) const {
    const std::string command = "cd '" + string() + "' && ffmpeg -loglevel quiet -y " + arguments +
                                " >/dev/null 2>&1 </dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
};

/// A test of video files, which ffmpeg makes; skipped where there is none.
class VideoFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!isInstalled("ffmpeg")) GTEST_SKIP() << "needs ffmpeg";
  }
  void ffmpeg(const std::string& arguments) const { folder.ffmpeg(arguments); }
  SourceFolder folder;
};

/// The line a SourceError says; "" (and a failed test) if nothing is thrown or it is not one line.
inline std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const SourceError& error) {
    std::string line = error.what();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    return line;
  }
  ADD_FAILURE() << "no SourceError";
  return "";
}

/// The error of openSource().
inline std::string openError(const std::string& spec, double fps = 0.0) {
  return errorOf([&] { (void)openSource(spec, fps); });
}

}  // namespace hapticast::server
