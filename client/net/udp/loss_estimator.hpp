// SPDX-License-Identifier: MIT
// How many of the datagrams that were sent do not arrive, and how many copies of each that asks
// for. Counts every copy of every part, so that both what is lost and what is lost in all its
// copies is seen: losses that come in bursts are not taken for independent ones. Pure. Thread:
// network.
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
  /// Of a network of which nothing is known yet.
  static constexpr std::uint32_t kFirstCopies = 3;
  /// Chosen: of what is sent at most so much may be lost in all its copies.
  static constexpr double kTolerated = 0.002;
  static constexpr Duration kJudgeEvery = std::chrono::seconds(1);
  /// Copies come at most three frames later; what has not come by then is lost.
  static constexpr std::uint64_t kSettled = 8;  ///< frames
  /// Fewer copies only after so long without need, so that a network that loses in bursts is
  /// not judged by its pauses.
  static constexpr Duration kPatience = std::chrono::seconds(30);

  /// `fixed`: so many copies are sent whatever is lost.
  explicit LossEstimator(std::uint32_t copies = kFirstCopies, bool fixed = false)
      : copies_(copies), fixed_(fixed) {}

  /// A datagram has come that the server has signed; no probe.
  void add(const DatagramHeader& header);
  /// One has come again, as far as can be told without its signature.
  void onDuplicate(const DatagramHeader& header);
  /// How many copies to ask for from now on.
  std::uint32_t copies(LocalTime now);
  [[nodiscard]] double loss() const { return loss_; }  ///< 0..1, as last measured

 private:
  /// Of a frame's parts: how often each has come.
  using Reception = std::vector<std::uint8_t>;
  static void count(Reception& received, std::size_t part);
  /// How many parts came so often or oftener; those that came 0 times or oftener are all.
  struct Tally {
    std::array<double, limits::kMostCopies + 1> parts{};
  };
  /// Takes the frames of which no copy can come any more.
  [[nodiscard]] Tally popSettled();
  void judge();

  std::map<std::uint64_t, Reception> frames_;  // by id, since the last judgement
  std::uint64_t judged_ = 0;                   // all frames up to this one are
  std::uint64_t ignored_ = 0;  // up to this one they were sent in another number of copies
  std::uint32_t copies_;
  bool fixed_;
  double loss_ = 0.0;
  double lost_ = 0.0;        // share of parts of which no copy came
  double lost_fewer_ = 0.0;  // the same, were there one copy less
  std::uint32_t needed_ = kFirstCopies;
  LocalTime judged_at_{};
  std::optional<LocalTime> needed_at_;  // when as many as now were needed last
};

}  // namespace hapticast::client
