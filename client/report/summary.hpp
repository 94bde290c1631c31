// SPDX-License-Identifier: MIT
// Results of a run, as a JSON file (--summary) and as text. client/report/README.md lists the keys
// of the JSON object.
// Thread: main, after the run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/device/loop/loop.hpp"
#include "client/device/loop/realtime_thread.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "client/net/udp/udp_socket.hpp"

namespace hapticast::client {

/// Counters of all parts of the client.
struct RunResult {
  LoopStats loop;
  ReceiverCounts frames;
  std::uint64_t bytes_received = 0;
  DatagramCounts datagrams;
  DeliveryStats delivery;
  double playout_delay_ms = 0.0;        ///< playout delay at the end of the run
  double clock_offset_us = 0.0;         ///< media clock - local clock
  double clock_error_us = 0.0;          ///< largest error of the offset
  Histogram eye_hand_ns;                ///< see View::eyeHand(); empty without a window
  std::optional<DeviceTraffic> device;  ///< nullopt for a device without a protocol
  RealtimeGrant realtime;
};

/// Writes `result` to `file` as one JSON object. A number that is not finite becomes null. Throws
/// std::runtime_error with the name of the file if it cannot be written.
void writeSummary(const std::string& file, const RunResult& result);
/// Returns a summary of `result` in a few sentences, for the user.
[[nodiscard]] std::string toText(const RunResult& result);

}  // namespace hapticast::client
