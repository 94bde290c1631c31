// SPDX-License-Identifier: MIT
// State of an origin or an edge on its channel, for operators. Thread: any.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace hapticast::server {

/// State of one server on a channel of NATS.
struct RelayCounts {
  bool is_edge = false;    ///< an edge; otherwise an origin
  bool connected = false;  ///< connected to NATS
  bool active = false;     ///< origin: it is active; edge: an origin sends to it
  std::uint64_t term = 0;  ///< of the active origin; 0: none known
  /// Time of the last heartbeat: an active origin's own, otherwise the last one that arrived.
  std::optional<LocalTime> heartbeat = std::nullopt;
};

}  // namespace hapticast::server
