// SPDX-License-Identifier: MIT
// Flags of the user's own programs: --depth-from, --depth-cache, --depth-cache-limit, --mask-from.
// Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Adds the flags to `app`. `settings` must outlive `app`.
void addChildOptions(CLI::App& app, ChildSettings& settings);

/// Refuses flags that contradict --depth-from or need one of these flags. Throws
/// CLI::ValidationError.
void requireChildFlags(const CLI::App& app, const Settings& settings);

}  // namespace hapticast::server
