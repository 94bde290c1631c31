// SPDX-License-Identifier: MIT
// Estimates the loss of datagrams, and the redundancy that the loss requires. Redundancy: the
// number of times that the server sends each datagram. The estimator counts how often each fragment
// arrives. From these counts it computes two values: the loss of single datagrams, and the share of
// the fragments that are lost in all their sends. Burst losses increase the second value more than
// independent losses do. Times are arguments. Thread: network.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/transport/datagram.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::client {

class LossEstimator {
 public:
  /// Redundancy at the start, before a measurement.
  static constexpr std::uint32_t kFirstCopies = 3;
  /// Tolerated share of the fragments that are lost in all their sends. The value is a choice.
  static constexpr double kTolerated = 0.002;
  static constexpr Duration kJudgeEvery = std::chrono::seconds(1);
  /// Number of frames after which a missing fragment counts as lost. The sends of a datagram are at
  /// most three frames apart.
  static constexpr std::uint64_t kSettled = 8;
  /// The redundancy decreases only after a lower one was sufficient for this time. A network with
  /// burst losses also has times without losses.
  static constexpr Duration kPatience = std::chrono::seconds(30);
  /// The same time for the redundancy at the start, which no measurement has required. The value is
  /// a choice.
  static constexpr Duration kFirstPatience = std::chrono::seconds(2);

  /// Starts with the redundancy `copies`. If `fixed` is true, the redundancy never changes,
  /// whatever the loss is.
  explicit LossEstimator(std::uint32_t copies = kFirstCopies, bool fixed = false)
      : copies_(copies), fixed_(fixed) {}

  /// Counts a datagram that is no probe. Its signature must be verified.
  void add(const DatagramHeader& header);
  /// Counts a duplicate of a datagram. Its signature is not verified.
  void onDuplicate(const DatagramHeader& header);
  /// Updates the estimate if a second has passed. Returns the redundancy that the client has to
  /// request from now on, 1 to 4.
  std::uint32_t copies(LocalTime now);
  /// Share of the datagrams that were lost, 0..1.
  [[nodiscard]] double loss() const { return loss_; }

 private:
  /// Number of arrivals of each fragment of a frame.
  using Reception = std::vector<std::uint8_t>;
  static void count(Reception& received, std::size_t part);
  /// Number of fragments by arrivals: parts[k] counts those that arrived at least k times. parts[0]
  /// estimates all fragments: of a frame of which none arrived, it assumes a mean number, so it may
  /// be a fraction. Of a frame only the first 256 fragments count.
  struct Tally {
    std::array<double, limits::kMostCopies + 1> parts{};
  };
  /// Removes the frames for which no more sends can arrive, and counts their fragments.
  [[nodiscard]] Tally popSettled();
  void judge();

  std::map<std::uint64_t, Reception> frames_;  // by id, since the last update
  std::uint64_t judged_ = 0;                   // all frames up to this id are counted
  std::uint64_t ignored_ = 0;                  // frames up to this id had another redundancy
  std::uint32_t copies_;
  bool fixed_;
  bool changed_ = false;  // copies_ is no longer the redundancy at the start
  double loss_ = 0.0;
  double lost_ = 0.0;        // share of fragments that are lost in all sends
  double lost_fewer_ = 0.0;  // the same, for one send less
  std::uint32_t needed_ = kFirstCopies;
  LocalTime judged_at_{};
  std::optional<LocalTime> needed_at_;  // last time when the present redundancy was needed
};

}  // namespace hapticast::client
