// SPDX-License-Identifier: MIT
// Connections that are no viewers: their places, and who leaves first. Thread: the network's.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "server/stream/session.hpp"

namespace hapticast::server {

using Sessions = std::vector<std::shared_ptr<Session>>;

/// A list of sessions, the oldest first, with a limit of their number.
class LimitedSessions {
 public:
  explicit LimitedSessions(std::size_t most) : most_(most) {}

  /// Adds `session`. Returns the session to close if there are too many, else null. It is the
  /// oldest one of the network with most of these sessions, so that a single host cannot occupy all
  /// places.
  [[nodiscard]] std::shared_ptr<Session> add(const std::shared_ptr<Session>& session);
  /// Removes `session`. Returns whether it was in the list.
  bool remove(const std::shared_ptr<Session>& session) {
    return std::erase(sessions_, session) > 0;
  }
  [[nodiscard]] const Sessions& all() const { return sessions_; }

 private:
  std::size_t most_;
  Sessions sessions_;
};

}  // namespace hapticast::server
