// SPDX-License-Identifier: MIT
// Replay protection of relayed messages: a signed message counts once. It keeps the highest number
// of each origin whose signature was valid; a message with an equal or lower one is a repetition.
// The check costs no signature, so a flood of repetitions costs little. Thread: one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hapticast::server {

/// The highest numbers of the origins of a channel.
class SeenNumbers {
 public:
  /// Most origins that are known at a time; the one whose last message is the oldest goes first.
  /// Chosen: far more than a channel has in a day.
  static constexpr std::size_t kMostOrigins = 256;

  /// Returns whether no message with this number, or with a higher one, was added.
  [[nodiscard]] bool isNew(std::uint64_t origin, std::uint64_t number) const {
    const auto found = find(origin);
    return found == seen_.end() || number > found->number;
  }
  /// Adds a message with a valid signature.
  void add(std::uint64_t origin, std::uint64_t number) {
    const auto found = find(origin);
    if (found != seen_.end()) {
      number = std::max(number, found->number);
      seen_.erase(found);
    } else if (seen_.size() == kMostOrigins) {
      seen_.erase(seen_.begin());
    }
    seen_.push_back({origin, number});
  }

 private:
  struct Seen {
    std::uint64_t origin;
    std::uint64_t number;
  };
  [[nodiscard]] std::vector<Seen>::const_iterator find(std::uint64_t origin) const {
    return std::find_if(seen_.begin(), seen_.end(),
                        [origin](const Seen& each) { return each.origin == origin; });
  }

  std::vector<Seen> seen_;  // the newest at the end
};

}  // namespace hapticast::server
