// SPDX-License-Identifier: MIT
// A sink for tests, and the example of server/show/README.md. Thread: the encoder's.
#pragma once

#include <cstdint>
#include <vector>

#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

/// A sink that keeps the number of each frame.
class FrameIds final : public StreamSink {
 public:
  void describe(const StreamDescription& /*description*/) override {}
  void changeKey(const DatagramKey& /*key*/) override {}
  void publish(EncodedFrame frame) override { ids.push_back(frame.id); }
  void publish(EncodedVideo /*video*/) override {}
  [[nodiscard]] bool videoWanted() const override { return false; }
  [[nodiscard]] bool datagramsWanted() const override { return false; }

  std::vector<std::uint64_t> ids;
};

}  // namespace hapticast::server
