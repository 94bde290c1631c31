// SPDX-License-Identifier: MIT
// Shared by the tests of folders of images: a folder with frames.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {

inline cv::Mat color(int level, cv::Size size = {32, 24}) {
  return {size, CV_8UC3, cv::Scalar::all(level)};
}
inline cv::Mat depth16(int value, cv::Size size = {32, 24}) {
  return {size, CV_16UC1, cv::Scalar(value)};
}
inline cv::Mat depth8(int value, cv::Size size = {32, 24}) {
  return {size, CV_8UC1, cv::Scalar(value)};
}

inline std::string number(int i) {
  const std::string digits = std::to_string(i);
  return std::string(6 - digits.size(), '0') + digits;
}

/// Five frames of 16-bit depth: 1000 mm + frame; colour level 10 x frame.
class ImageSequenceFolder : public testing::Test {
 protected:
  void fill(int frames = 5) const {
    for (int i = 0; i < frames; ++i) {
      folder.write("rgb/" + number(i) + ".png", color(10 * i));
      folder.write("depth/" + number(i) + ".png", depth16(1000 + i));
    }
  }
  [[nodiscard]] std::string openError() const {
    return errorOf([this] { ImageSequence(folder.string(), 0.0); });
  }
  SourceFolder folder;
};

}  // namespace hapticast::server
