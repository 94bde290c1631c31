// SPDX-License-Identifier: MIT
// How the client trusts its server, and shows that it may connect: TLS with an authority or with
// the key of the first connection, and the access token. Thread: main, at start-up.
#pragma once

#include <string>

#include "client/net/dial.hpp"
#include "client/settings.hpp"

namespace hapticast::client {

/// Returns the name of the server: [hapticasts://]HOST:PORT, or mdns:NAME.
[[nodiscard]] std::string nameServer(const Settings& settings);

/// Returns the dial function for the server of `settings`, whose name in messages and in the file
/// of known servers is `server`. It uses TLS for hapticasts:// and for an announced server with
/// TLS. Throws std::runtime_error (one line) if a file cannot be used.
[[nodiscard]] Dial chooseDial(const Settings& settings, const std::string& server);

/// Returns the access token in `file`, without white space around it; empty if `file` is. Throws
/// std::runtime_error (one line) if the file has no token of 1 to 256 bytes.
[[nodiscard]] std::string loadToken(const std::string& file);

}  // namespace hapticast::client
