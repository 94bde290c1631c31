// SPDX-License-Identifier: MIT
// Outputs of a program's messages that the user asked for. Thread: any.
#pragma once

#include <optional>
#include <string>

#include "common/endpoint.hpp"

namespace hapticast {

/// Outputs of messages.
struct OutputSettings {
  std::string record;            ///< file of the recording; empty: none
  std::optional<Endpoint> live;  ///< port for watchers; nullopt: none
  [[nodiscard]] bool wanted() const { return !record.empty() || live; }
};

}  // namespace hapticast
