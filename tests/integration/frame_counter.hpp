// SPDX-License-Identifier: MIT
// A viewer beside those of a test, which counts frames: the event that a server streams.
#pragma once

#include <string>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {

inline std::uint16_t portOf(const std::string& address) {
  return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

/// Whether a new viewer of the server at `address` gets so many frames.
inline bool deliversFrames(const std::string& address, std::size_t frames) {
  asio::io_context io;
  RawPeer viewer(io, portOf(address));
  viewer.send(Hello{kProtocolVersion, "counts", false, true});
  return waitUntil(kSoon, [&, turn = 0]() mutable {
    if (turn++ % 50 == 0) viewer.send(Ping{});
    viewer.poll();
    return viewer.all<CodedFrame>().size() >= frames;
  });
}

}  // namespace hapticast::testing
