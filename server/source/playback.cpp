// SPDX-License-Identifier: MIT
#include "server/source/playback.hpp"

namespace hapticast::server {

std::optional<RgbdFrame> readOn(RgbdSource& source, std::uint64_t skip, bool loop) {
  bool progress = true;  // a whole round without a frame must not go on for ever
  for (;;) {
    while (skip > 0 && source.skip()) {
      --skip;
      progress = true;
    }
    if (skip == 0) {
      if (auto frame = source.read()) return frame;
    }
    if (!loop || source.info().live || !progress) return std::nullopt;
    source.rewind();
    progress = false;
  }
}

}  // namespace hapticast::server
