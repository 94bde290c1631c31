// SPDX-License-Identifier: MIT
#include "server/source/picture/picture_size.hpp"

#include "common/haptic_frame.hpp"

namespace hapticast::server {

std::string sizeText(int width_px, int height_px) {
  return std::to_string(width_px) + "x" + std::to_string(height_px);
}

bool sizeReadable(std::int64_t width_px, std::int64_t height_px) {
  return width_px >= 1 && height_px >= 1 && width_px <= kMostSide_px && height_px <= kMostSide_px &&
         width_px * height_px <= kMostPixels;
}

std::string describeTooLarge(std::int64_t width_px, std::int64_t height_px) {
  return "is " + std::to_string(width_px) + "x" + std::to_string(height_px) + ", larger than " +
         std::to_string(kMostSide_px) + " px a side or " + sizeText(kMostSide_px, 4320) + " in all";
}

bool sizeAllowed(int width_px, int height_px) {
  return width_px >= 1 && height_px >= 1 && width_px <= kMaxWidth_px && height_px <= kMaxHeight_px;
}

}  // namespace hapticast::server
