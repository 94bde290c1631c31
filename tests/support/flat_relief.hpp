// SPDX-License-Identifier: MIT
// The simplest relief there is: one height over a whole rectangle.
#pragma once

#include <cstddef>
#include <memory>

#include "common/haptic_frame.hpp"

namespace hapticast {

inline std::shared_ptr<Relief> flatRelief(const PixelRect& rect, float height_mm = 5.0F) {
  auto relief = std::make_shared<Relief>();
  relief->rect = rect;
  const std::size_t pixels = rect.pixels();
  relief->height_mm.assign(pixels, height_mm);
  relief->mask.assign(pixels, 1);
  return relief;
}

}  // namespace hapticast
