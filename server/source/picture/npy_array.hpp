// SPDX-License-Identifier: MIT
// Arrays of numbers in NumPy's format NPY (version 1 to 3), as depth pictures. Functions check the
// header and the limits of pictures before they allocate memory. They describe a problem by a
// phrase that follows the file's name in a message. Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "server/source/picture/byte_stream.hpp"
#include "server/source/picture/image_result.hpp"

namespace hapticast::server {

/// Dimensions that an array must have.
enum class NpyShape : std::uint8_t {
  kMatrix,  ///< (height, width)
  kStack,   ///< (pictures, height, width)
};

/// Facts about an array, which readNpyHeader() has checked.
struct NpyHeader {
  std::uint64_t count = 1;  ///< pictures; 1 for kMatrix
  cv::Size size;            ///< of each picture, readable by sizeReadable()
  int type = CV_8UC1;       ///< of OpenCV: CV_8UC1, CV_16UC1, CV_16FC1, CV_32FC1 or CV_64FC1
  std::uint64_t begin = 0;  ///< where the first picture begins, bytes

  /// Returns the size of one picture, bytes.
  [[nodiscard]] std::uint64_t pictureBytes() const;
};

/// A header, or a phrase with its problem.
struct NpyHeaderResult {
  NpyHeader header;
  std::string problem;
};

/// Returns true if `bytes` begin like an NPY file.
[[nodiscard]] bool isNpy(std::span<const std::uint8_t> bytes);

/// Reads the header of the array in `stream`, which is at its begin. The array has the order of C,
/// and its values are |u1, <u2, <f2, <f4 or <f8. It is a problem too if the stream is too short for
/// the pictures that the header states.
[[nodiscard]] NpyHeaderResult readNpyHeader(ByteStream& stream, NpyShape shape);

/// Reads the next picture of the array from `stream`, which is at its begin. The image is CV_8UC1,
/// CV_16UC1 or CV_32FC1. Returns the image, or its problem.
[[nodiscard]] ImageResult readNpyPicture(ByteStream& stream, const NpyHeader& header);

/// Returns the matrix in `stream`, an array with its header, or its problem.
[[nodiscard]] ImageResult readNpyMatrix(ByteStream& stream);

}  // namespace hapticast::server
