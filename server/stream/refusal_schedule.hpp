// SPDX-License-Identifier: MIT
// Times of the answers to wrong access tokens: at most one in a second for each network, so that
// guesses are slow. Thread: one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace hapticast::server {

/// The next time of an answer, for each network.
class RefusalSchedule {
 public:
  static constexpr Duration kEvery = std::chrono::seconds(1);
  /// Largest number of networks with a time of their own. All other networks share one.
  static constexpr std::size_t kMostNetworks = 1024;

  /// Reserves the next time for an answer to `network` and returns it, at the earliest `now`.
  /// Returns nullopt, and reserves nothing, if that time is after `latest`. Requires: `now` does
  /// not decrease.
  [[nodiscard]] std::optional<LocalTime> reserve(const std::string& network, LocalTime now,
                                                 LocalTime latest) {
    if (next_.size() >= kMostNetworks)
      std::erase_if(next_, [now](const auto& each) { return each.second <= now; });
    const bool full = next_.size() >= kMostNetworks && next_.find(network) == next_.end();
    LocalTime& next = full ? next_of_others_ : next_[network];
    const LocalTime time = std::max(now, next);
    if (time > latest) return std::nullopt;
    next = time + kEvery;
    return time;
  }
  /// Returns the number of networks with a time of their own.
  [[nodiscard]] std::size_t size() const { return next_.size(); }

 private:
  std::map<std::string, LocalTime> next_;
  LocalTime next_of_others_{};
};

}  // namespace hapticast::server
