// SPDX-License-Identifier: MIT
// Subcommand control: sends one request of an operator to a server, and waits for the server's
// answer.
// Thread: main.
#pragma once

#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Sends settings.control to the server. Returns true if the server has accepted it. Otherwise logs
/// the reason in one line. Throws std::runtime_error (one line) if a file cannot be used.
bool controlServer(const Settings& settings);

}  // namespace hapticast::client
