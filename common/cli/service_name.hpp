// SPDX-License-Identifier: MIT
// Names of servers on the command line, and whether this build can look for them. Thread: main, at
// start-up.
#pragma once

#include <string>

namespace hapticast {

/// Throws CLI::ValidationError, which names `flag`, in a build that cannot look for servers.
void requireDiscovery(const std::string& flag);

/// `text`, when a server can be announced by it; throws CLI::ValidationError otherwise.
[[nodiscard]] std::string serviceName(const std::string& flag, const std::string& text);

}  // namespace hapticast
