// SPDX-License-Identifier: MIT
// Access to a stream by tokens. Without a list of tokens everybody may view. Answers to wrong
// tokens are slow (refusal_schedule.hpp). Thread: one.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "common/transport/channel.hpp"
#include "common/wire_error.hpp"
#include "server/stream/access_list.hpp"
#include "server/stream/refusal_schedule.hpp"

namespace hapticast::server {

class StreamAccess {
 public:
  /// `insecure`: other machines may send their tokens without TLS.
  explicit StreamAccess(bool insecure) : insecure_(insecure) {}

  /// Requires tokens of `list` from now on.
  void set(AccessList list) { list_ = std::move(list); }
  /// Returns the reason why a client with `token` may not view, or nullopt.
  [[nodiscard]] std::optional<WireError> refuse(const std::string& token,
                                                const Channel& channel) const;
  /// Returns what `token` permits; nullopt without a list, or for an unknown token.
  [[nodiscard]] std::optional<Grant> findGrant(const std::string& token) const {
    return list_ ? list_->find(token) : std::nullopt;
  }
  /// Returns whether a viewer with `grant` may stay now.
  [[nodiscard]] bool permits(const std::optional<Grant>& grant) const;
  /// Reserves the time of an answer to a wrong token, as RefusalSchedule::reserve() does.
  [[nodiscard]] std::optional<LocalTime> reserveRefusal(const std::string& network, LocalTime now,
                                                        LocalTime latest) {
    return refusals_.reserve(network, now, latest);
  }

 private:
  std::optional<AccessList> list_;  // absent: no tokens are needed
  RefusalSchedule refusals_;
  bool insecure_;
};

}  // namespace hapticast::server
