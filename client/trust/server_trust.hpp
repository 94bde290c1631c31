// SPDX-License-Identifier: MIT
// Authentication of the server and of the client. The client authenticates the server by TLS: by a
// certificate authority (--tls-ca), or by the key of the first connection (known_origins.hpp). The
// server authenticates the client by the access token.
// Thread: main, at start-up.
#pragma once

#include <string>

#include "client/net/client_session.hpp"
#include "client/net/dial.hpp"
#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Returns `address` without hapticast:// or hapticasts:// at its begin. Sets `tls` to whether it
/// began with hapticasts://.
[[nodiscard]] std::string removeScheme(const std::string& address, bool& tls);

/// Returns the name of the server: [hapticasts://]HOST:PORT, or mdns:NAME.
[[nodiscard]] std::string nameServer(const Settings& settings);

/// Returns the dial function for the server of `settings`. `server` is the result of nameServer().
/// The function uses TLS for hapticasts://, for a server that announces TLS, and for an announced
/// server that once had TLS. Throws std::runtime_error (one line) if a file cannot be used.
[[nodiscard]] Dial chooseDial(const Settings& settings, const std::string& server);

/// Returns the settings of sessions with the server of `settings`: origin, access token. `server`
/// is the result of nameServer(). Throws std::runtime_error (one line) if a file cannot be used.
[[nodiscard]] SessionSettings makeSessionSettings(const Settings& settings,
                                                  const std::string& server);

/// Returns the access token in `file`, without the white space around it. Returns an empty text if
/// `file` is an empty name. Throws std::runtime_error (one line) if the file has no token of 1 to
/// 256 bytes.
[[nodiscard]] std::string loadToken(const std::string& file);

}  // namespace hapticast::client
