// SPDX-License-Identifier: MIT
// Authentication of the server and of the client. The client authenticates the server by TLS: by a
// certificate authority (--tls-ca), or by the key of the first connection (known_origins.hpp). The
// server authenticates the client by the access token.
// Thread: main, at start-up.
#pragma once

#include <string>
#include <vector>

#include "client/net/client_session.hpp"
#include "client/net/dial.hpp"
#include "client/net/origin_pin.hpp"
#include "common/endpoint.hpp"

namespace hapticast::client {

/// Which server, and what the client requires of it.
struct ServerSettings {
  Endpoint server{"localhost", kDefaultPort};
  std::string announced;               ///< name of the server from mdns:NAME; empty: use `server`
  bool server_given = false;           ///< the user named a server
  bool tls = false;                    ///< the address begins with hapticasts://
  std::string tls_ca_file;             ///< certificate authorities; empty: trust on first use
  std::string token_file;              ///< file with the access token; empty: no token
  bool insecure = false;               ///< the client may send the token without TLS
  std::vector<OriginKey> origin_keys;  ///< accepted keys; empty: any key or none
};

inline constexpr const char* kServerForm = "HOST[:PORT]|hapticasts://HOST[:PORT]|mdns:NAME";
/// Writes the server that `text` names into `settings`. Returns false if `text` has another form
/// than kServerForm, a PORT alone or hapticast://HOST[:PORT]; then `settings` are undefined.
[[nodiscard]] bool parseServer(const std::string& text, ServerSettings& settings);

/// Returns the name of the server: [hapticasts://]HOST:PORT, or mdns:NAME.
[[nodiscard]] std::string nameServer(const ServerSettings& settings);

/// Returns the dial function for the server of `settings`. `server` is the result of nameServer().
/// The function uses TLS for hapticasts://, for a server that announces TLS, and for an announced
/// server that once had TLS. Throws std::runtime_error (one line) if a file cannot be used.
[[nodiscard]] Dial chooseDial(const ServerSettings& settings, const std::string& server);

/// Returns the settings of sessions with the server of `settings`: origin, access token. `server`
/// is the result of nameServer(). Throws std::runtime_error (one line) if a file cannot be used.
[[nodiscard]] SessionSettings makeSessionSettings(const ServerSettings& settings,
                                                  const std::string& server);

/// Returns the access token in `file`, without the white space around it. Returns an empty text if
/// `file` is an empty name. Throws std::runtime_error (one line) if the file has no token of 1 to
/// 256 bytes.
[[nodiscard]] std::string loadToken(const std::string& file);

}  // namespace hapticast::client
