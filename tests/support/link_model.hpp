// SPDX-License-Identifier: MIT
// A bad network, decided packet by packet: pure, seeded, time
// is an argument, so that the same link can stand between sockets (lossy_link.hpp) and under a
// virtual clock. Thread: one per link.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>

#include "common/time.hpp"

namespace hapticast::testing {

enum class Jitter {
  kUniform,  ///< 0 to `jitter` on top of the delay
  kNormal,   ///< `jitter` is the standard deviation around the delay; nothing arrives before now
  kExponential,  ///< `jitter` is the mean on top of the delay: a few come very late
};

/// One direction of a link.
struct LinkProfile {
  Duration delay{0};
  Duration jitter{0};
  Jitter distribution = Jitter::kUniform;
  double loss = 0.0;         ///< share of packets
  double burst = 1.0;        ///< mean length of a run of lost ones; up to 1: each by itself
  double duplicate = 0.0;    ///< share of datagrams that come twice
  double reorder = 0.0;      ///< share of datagrams that later ones may overtake
  double rate_bits_s = 0.0;  ///< 0: as fast as they come
  std::size_t queue_bytes = 128 << 10;  ///< that wait for the rate; what is more is lost
  std::size_t largest_bytes = 65535;    ///< datagrams; of a larger one nothing is ever seen
  std::uint64_t seed = 1;
};

/// Packets: datagrams, or of a stream what one segment of TCP carries.
struct LinkCounts {
  std::uint64_t packets = 0;  ///< that went in
  std::uint64_t bytes = 0;
  std::uint64_t lost = 0;       ///< by chance
  std::uint64_t too_large = 0;  ///< datagrams only
  std::uint64_t overflowed = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
  std::uint64_t stalled = 0;     ///< datagrams that came in a stall; none of the packets
  std::uint64_t deliveries = 0;  ///< datagrams that came out, or pieces of a stream
  Duration delay{0};             ///< of all deliveries, summed

  bool operator==(const LinkCounts&) const = default;
};

/// Shared by all packets of one direction: its rate and its counts.
struct LinkWay {
  LinkProfile profile;
  LinkCounts counts;
  LocalTime free_at;  ///< when all that wait for the rate are on their way
};

/// One flow of packets on a way.
class LinkModel {
 public:
  static constexpr std::size_t kHeaderBytes = 28;     ///< IPv4 and UDP; they take of the rate, too
  static constexpr std::size_t kSegmentBytes = 1448;  ///< what TCP sends in one packet of Ethernet
  /// TCP's own least pause before it sends again what was lost (Linux; RFC 6298 asks for more).
  static constexpr Duration kLeastResend = std::chrono::milliseconds(200);
  /// Up to so much later comes what others may overtake; chosen: behind the rest of its frame, and
  /// now and then behind the next frame.
  static constexpr Duration kHeldBack = std::chrono::milliseconds(40);

  /// `way` outlives it; its profile may change at any time. Flows of different `flow` number differ
  /// in what happens to them.
  explicit LinkModel(LinkWay& way, std::uint32_t flow = 0);

  /// When the copies of a datagram come out; none: it is lost.
  struct Arrivals {
    std::array<LocalTime, 2> at;
    std::size_t count = 0;
  };
  [[nodiscard]] Arrivals datagram(LocalTime now, std::size_t bytes);

  /// When bytes of a stream come out: in order, and after a round trip (twice the delay) more where
  /// a packet of them is lost. Does not look at what a full queue would lose: ask room().
  [[nodiscard]] LocalTime stream(LocalTime now, std::size_t bytes);
  /// Whether the queue for the rate takes so many bytes more.
  [[nodiscard]] bool room(LocalTime now, std::size_t bytes) const;

 private:
  [[nodiscard]] double chance();  // 0 < it < 1
  [[nodiscard]] bool lost();
  [[nodiscard]] Duration travel();
  /// When the last of so many bytes has left, for which all before them leave first.
  LocalTime leave(LocalTime now, std::size_t bytes);

  LinkWay& way_;
  std::mt19937 random_;
  bool losing_ = false;  // the packet before was lost
  LocalTime last_;       // the latest arrival of those that keep their order
};

}  // namespace hapticast::testing
