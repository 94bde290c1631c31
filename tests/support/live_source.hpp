// SPDX-License-Identifier: MIT
// Reads live sources, whose read() returns nullopt while no frame comes.
#pragma once

#include <optional>

#include "server/source/rgbd_source.hpp"

namespace hapticast::testing {

/// Returns the next frame of a live source; nullopt if none comes for about 60 s.
inline std::optional<server::RgbdFrame> readLive(server::RgbdSource& source) {
  constexpr int kMostReads = 1200;  // of 50 ms
  for (int i = 0; i < kMostReads; ++i) {
    if (auto frame = source.read()) return frame;
  }
  return std::nullopt;
}

}  // namespace hapticast::testing
