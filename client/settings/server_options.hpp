// SPDX-License-Identifier: MIT
// Flags of the server that the client connects to. Thread: main, at start-up.
#pragma once

#include "client/settings/settings.hpp"
#include "common/cli/cli11.hpp"

namespace hapticast::client {

/// Adds the address of the server, and the flags of trust between client and server, to `app`. They
/// write to `settings`, which must outlive `app`.
void addServerOptions(CLI::App& app, Settings& settings);

/// Adds the flags of the transport of frames. As above.
void addDeliveryOptions(CLI::App& app, Settings& settings);

}  // namespace hapticast::client
