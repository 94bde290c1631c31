// SPDX-License-Identifier: MIT
// Pictures as Video4Linux2 devices deliver them: raw bytes and a format. The format comes from a
// device, so all functions check it. Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

/// Returns the code of a pixel format from its four characters, as in linux/videodev2.h.
constexpr std::uint32_t fourCc(const char (&text)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8U | static_cast<std::uint8_t>(text[i]);
  return code;
}

/// Format of the pictures of a device.
struct V4l2Format {
  std::uint32_t code = 0;  ///< see fourCc()
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t row_bytes = 0;  ///< from row to row; 0: the rows have no gaps
};

// The supported formats, best first: uncompressed before compressed, depth in mm before 8-bit
// depth.
inline constexpr std::uint32_t kColorCodes[] = {fourCc("YUYV"), fourCc("UYVY"), fourCc("NV12"),
                                                fourCc("YU12"), fourCc("BGR3"), fourCc("RGB3"),
                                                fourCc("MJPG"), fourCc("JPEG")};
inline constexpr std::uint32_t kDepthCodes[] = {fourCc("Z16 "), fourCc("Y16 "), fourCc("GREY"),
                                                fourCc("BGR3"), fourCc("RGB3")};

/// Returns the meaning of the depth in pictures of the format `code`: mm with 16 bits, height (near
/// is white) with 8 bits.
[[nodiscard]] constexpr DepthKind findDepthKind(std::uint32_t code) {
  return code == fourCc("Z16 ") || code == fourCc("Y16 ") ? DepthKind::kMetric : DepthKind::kHeight;
}

/// Return the picture in `bytes` (CV_8UC3 in the order BGR; CV_32FC1, see RgbdFrame::depth), or its
/// problem. They check sizes and lengths before they read or allocate. `bytes` may be longer than
/// the picture.
[[nodiscard]] ImageResult readV4l2Color(const V4l2Format& format,
                                        std::span<const std::uint8_t> bytes);
[[nodiscard]] ImageResult readV4l2Depth(const V4l2Format& format,
                                        std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
