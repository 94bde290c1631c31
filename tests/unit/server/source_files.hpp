// SPDX-License-Identifier: MIT
// What the tests of sources share: a folder of their own, images in it, the log's warnings, the
// text of an error.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "server/source/rgbd_source.hpp"
#include "tests/support/log_lines.hpp"

namespace hapticast::server {

/// A folder of this test's own, removed with all in it.
class TempFolder {
 public:
  TempFolder() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    path_ =
        std::filesystem::path(testing::TempDir()) / ("hapticast_" + std::to_string(getpid()) + "_" +
                                                     test->test_suite_name() + "_" + test->name());
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  [[nodiscard]] std::string string() const { return path_.string(); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  void write(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    ASSERT_TRUE(cv::imwrite((path_ / name).string(), image));
  }

 private:
  std::filesystem::path path_;
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

/// What openSource() complains of.
inline std::string openError(const std::string& spec, double fps = 0.0) {
  return errorOf([&] { (void)openSource(spec, fps); });
}

}  // namespace hapticast::server
