// SPDX-License-Identifier: MIT
// What a run was like, in numbers (--summary; its keys are listed in README.md) and in words.
// Thread: main, after the run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/haptics/loop.hpp"
#include "client/haptics/realtime_thread.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/datagram_verifier.hpp"
#include "client/net/udp/transport_selector.hpp"

namespace hapticast::client {

/// Everything the parts of the client counted.
struct RunResult {
  LoopStats loop;
  ReceiverCounts frames;
  std::uint64_t bytes_received = 0;
  DatagramCounts datagrams;
  DeliveryStats delivery;
  double playout_delay_ms = 0.0;        ///< at the end
  double clock_offset_us = 0.0;         ///< media clock - local clock
  double clock_error_us = 0.0;          ///< its bound
  Histogram eye_hand_ns;                ///< View::eyeHand(); empty: nothing was shown
  std::optional<DeviceTraffic> device;  ///< none: nothing travels to it
  RealtimeGrant realtime;
};

/// Writes one JSON object; a number that is not finite is null. Throws std::runtime_error naming
/// the file when it cannot be written.
void writeSummary(const std::string& file, const RunResult& result);
/// A few sentences for people.
[[nodiscard]] std::string toText(const RunResult& result);

}  // namespace hapticast::client
