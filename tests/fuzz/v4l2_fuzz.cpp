// SPDX-License-Identifier: MIT
// Pictures of a Video4Linux2 device: 16 bytes of format, then what the device delivers. Whatever
// they are, nothing is read or written out of bounds, and a picture has the size of its format.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "server/source/live/v4l2_picture.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::v4l2 {
namespace {

void check(const hapticast::server::ImageResult& result, int type,
           const hapticast::server::V4l2Format& format) {
  if (!result.ok()) return;
  if (result.image.type() != type || result.image.cols != static_cast<int>(format.width_px) ||
      result.image.rows != static_cast<int>(format.height_px))
    std::abort();
}

}  // namespace

HAPTICAST_FUZZ_TARGET("v4l2") {
  hapticast::server::V4l2Format format;
  static_assert(sizeof(format) == 16);
  if (size < sizeof(format)) return 0;
  std::memcpy(&format, data, sizeof(format));
  const std::span<const std::uint8_t> bytes(data + sizeof(format), size - sizeof(format));
  check(readV4l2Color(format, bytes), CV_8UC3, format);
  check(readV4l2Depth(format, bytes), CV_32FC1, format);
  return 0;
}

}  // namespace hapticast::fuzz::v4l2
