// SPDX-License-Identifier: MIT
// Flags of a server for its viewers: addresses, transports, TLS, access, figures. The subcommands
// serve and relay have them. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Adds these flags to `app`. They write to `settings`, which must outlive `app`.
void addNetworkOptions(CLI::App& app, Settings& settings);

/// Adds the flags of NATS, for edges and for origins. `settings` must outlive `app`.
void addNatsOptions(CLI::App& app, Settings& settings);

/// Checks the flags of addNetworkOptions() after the parsing. Throws CLI::ValidationError for a
/// flag that needs another one.
void requireNetworkFlags(const Settings& settings);

}  // namespace hapticast::server
