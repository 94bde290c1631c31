// SPDX-License-Identifier: MIT
#include "server/source/playback.hpp"

namespace hapticast::server {

std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop) {
  while (skip > 0 && source.skip()) --skip;
  if (skip == 0) {
    if (auto frame = source.read()) return frame;
  }
  if (!loop || source.info().live) return std::nullopt;
  source.rewind();
  return source.read();
}

}  // namespace hapticast::server
