// SPDX-License-Identifier: MIT
// How many of the datagrams that were sent do not arrive, and how many copies of each that asks
// for. Counts every copy, so that what is measured is the network, repaired or not. Pure. Thread:
// network.
#pragma once

#include <cstdint>
#include <map>

#include "common/time.hpp"
#include "common/wire/limits.hpp"

namespace hapticast::client {

class LossMeter {
 public:
  /// Chosen: of what is sent at most so much may be lost in all its copies.
  static constexpr double kTolerated = 0.002;
  static constexpr Duration kJudgeEvery = std::chrono::seconds(1);
  /// Copies come at most three frames later; what has not come by then is lost.
  static constexpr std::uint64_t kSettled = 8;  ///< frames
  /// Fewer copies only after so long without need, so that a network that loses in bursts is
  /// not judged by its pauses.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  /// `fixed`: so many copies are sent whatever is lost.
  explicit LossMeter(std::uint32_t copies = 1, bool fixed = false)
      : copies_(copies), fixed_(fixed) {}

  /// A datagram of a frame of `parts` has come that the server has signed.
  void add(std::uint64_t frame, std::uint16_t parts);
  /// One has come again, as far as can be told without its signature.
  void again(std::uint64_t frame);
  /// How many copies to ask for from now on.
  std::uint32_t copies(LocalTime now);
  [[nodiscard]] double loss() const { return loss_; }  ///< 0..1, as last measured

 private:
  struct Came {
    std::uint32_t parts = 0;
    std::uint32_t came = 0;
  };
  void judge();

  std::map<std::uint64_t, Came> frames_;  // by id, since the last judgement
  std::uint64_t judged_ = 0;              // all frames up to this one are
  std::uint64_t ignored_ = 0;  // up to this one they were sent in another number of copies
  std::uint32_t copies_;
  bool fixed_;
  double loss_ = 0.0;
  std::uint32_t needed_ = 1;
  LocalTime judged_at_{};
  LocalTime needed_at_{};  // when as many as now were needed last
};

}  // namespace hapticast::client
