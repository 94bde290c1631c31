// SPDX-License-Identifier: MIT
// Names of servers on the command line, and whether this build supports discovery (DNS-SD). Thread:
// main, at start-up.
#pragma once

#include <string>

namespace hapticast {

/// Throws CLI::ValidationError with `flag` in a build without discovery.
void requireDiscovery(const std::string& flag);

/// Returns `text` if it is a valid service name; throws CLI::ValidationError otherwise.
[[nodiscard]] std::string serviceName(const std::string& flag, const std::string& text);

}  // namespace hapticast
