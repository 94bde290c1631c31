// SPDX-License-Identifier: MIT
// A viewer at the end of a network, in virtual time: the client's receiver, preparer, loss meter,
// playout clock and look-up, touched by a scripted hand at play time. Thread: any, each viewer for
// itself.
#pragma once

#include <memory>
#include <optional>

#include "client/net/udp/loss_estimator.hpp"
#include "common/time.hpp"
#include "common/transport/clock_sync.hpp"
#include "tests/evaluate/network/network_wire.hpp"
#include "tests/evaluate/touch/touch_player.hpp"

namespace hapticast::evaluate {

struct NetworkTick {
  double time_s = 0.0;  ///< play time
  Vec3 truth_mm = Vec3::Zero();
  Vec3 displacement_mm = Vec3::Zero();
  double delay_ms = 0.0;
  std::optional<Duration> clock_offset;  ///< once the clock is known
  double clock_error_ms = 0.0;
};

struct Conversation {
  double mean_copies = 1.0;  ///< that were asked for
  /// Of each frame: Wire::waited_ms().
  std::vector<double> waited_ms;
};

struct NetworkTrace {
  std::vector<NetworkTick> ticks;  ///< every millisecond since the viewer came
  Conversation conversation;
};

/// Plays a stream through a network to a viewer, of whatever class: it pings, takes what comes and
/// asks for copies as the client does. `ticked` gets the wire and what the viewer's tick() returns.
template <class Viewer, class Ticked>
Conversation runSession(const SentStream& stream, const Network& network, double seconds,
                        Viewer& viewer, const Ticked& ticked) {
  Wire wire(stream, network, viewer.now());
  client::LossEstimator meter;
  std::uint32_t copies = network.copies > 0 ? network.copies : client::LossEstimator::kFirstCopies;
  double copies_sum = 0.0;
  int pings = 0;
  double next_ping_s = 0.0;
  Welcome welcome;
  welcome.description = stream.description;
  (void)viewer.receive(encode(welcome));
  const Wire::Events events{
      [&](LocalTime at) { viewer.moveTo(at); },

      [&](std::span<const std::uint8_t> message) { (void)viewer.receive(message); },
      [&](const SentStream::Part& part) {
        meter.add(part.header);
        viewer.part(part.header, part.payload);
      }};
  for (int tick = 0; tick < static_cast<int>(seconds * 1e3); ++tick) {
    const LocalTime now = viewer.now();
    if (1e-3 * tick >= next_ping_s) {
      next_ping_s = 1e-3 * tick + (++pings < static_cast<int>(ClockSync::kBurst) ? 0.02 : 1.0);
      wire.ping(Ping{now});
    }
    wire.deliver(now, events);
    viewer.moveTo(now);
    if (network.datagrams && tick % 20 == 0) {
      const std::uint32_t wanted = network.copies > 0 ? network.copies : meter.copies(now);
      if (wanted != copies) wire.order(wanted, now);
      copies = wanted;
      viewer.expectCopies(copies);
    }
    copies_sum += copies;
    ticked(wire, viewer.tick());
  }
  return {copies_sum / (seconds * 1e3), wire.waited_ms()};
}

/// The force at a hand whose path is a function of play time.
NetworkTrace renderThroughNetwork(const SentStream& stream, const Network& network,
                                  const Hand& hand, double seconds);

}  // namespace hapticast::evaluate
