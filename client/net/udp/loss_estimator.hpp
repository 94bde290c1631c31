// SPDX-License-Identifier: MIT
// Estimates the loss of datagrams and the redundancy that it requires. It counts every send of
// every fragment, so that both the loss of single datagrams and the loss of all sends of a fragment
// are measured. So burst losses do not count as independent ones. Times are arguments.
// Thread: network.
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
  /// Redundancy for an unmeasured network.
  static constexpr std::uint32_t kFirstCopies = 3;
  /// Tolerated share of fragments that are lost in all sends. Chosen.
  static constexpr double kTolerated = 0.002;
  static constexpr Duration kJudgeEvery = std::chrono::seconds(1);
  /// Frames until a missing fragment counts as lost: the sends of a datagram are at most three
  /// frames apart.
  static constexpr std::uint64_t kSettled = 8;  ///< frames
  /// The redundancy falls only after this time without need, because a network with burst losses
  /// also has pauses.
  static constexpr Duration kPatience = std::chrono::seconds(30);

  /// With `fixed` the redundancy remains `copies`, whatever the loss.
  explicit LossEstimator(std::uint32_t copies = kFirstCopies, bool fixed = false)
      : copies_(copies), fixed_(fixed) {}

  /// Counts an authenticated datagram that is no probe.
  void add(const DatagramHeader& header);
  /// Counts a duplicate. Its signature is unverified.
  void onDuplicate(const DatagramHeader& header);
  /// Updates the estimate once a second. Returns the redundancy to request from now on, 1 to 4.
  std::uint32_t copies(LocalTime now);
  [[nodiscard]] double loss() const { return loss_; }  ///< loss of single datagrams, 0..1

 private:
  /// Number of arrivals of each fragment of a frame.
  using Reception = std::vector<std::uint8_t>;
  static void count(Reception& received, std::size_t part);
  /// parts[k]: fragments that arrived at least k times; parts[0] are all fragments.
  struct Tally {
    std::array<double, limits::kMostCopies + 1> parts{};
  };
  /// Removes and counts the frames that can receive no more sends.
  [[nodiscard]] Tally popSettled();
  void judge();

  std::map<std::uint64_t, Reception> frames_;  // by id, since the last update
  std::uint64_t judged_ = 0;                   // all frames up to this id are counted
  std::uint64_t ignored_ = 0;                  // frames up to this id had another redundancy
  std::uint32_t copies_;
  bool fixed_;
  double loss_ = 0.0;
  double lost_ = 0.0;        // share of fragments that are lost in all sends
  double lost_fewer_ = 0.0;  // the same, for one send less
  std::uint32_t needed_ = kFirstCopies;
  LocalTime judged_at_{};
  std::optional<LocalTime> needed_at_;  // last time when the present redundancy was needed
};

}  // namespace hapticast::client
