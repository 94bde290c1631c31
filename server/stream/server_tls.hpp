// SPDX-License-Identifier: MIT
// The server's end of TLS: certificate and key from files, or a self-signed pair that the server
// creates once. Thread: main, at start-up and at a reload.
#pragma once

#include <optional>
#include <string>

#include "common/transport/tls.hpp"
#include "server/stream/limited_log.hpp"

namespace hapticast::server {

/// Values of the flags of TLS.
struct TlsFiles {
  std::string certificate;  ///< --tls-cert: PEM, with its chain; empty: none
  std::string key;          ///< --tls-key: PEM
  bool automatic = false;   ///< --tls auto: a pair of the server's own

  [[nodiscard]] bool wanted() const { return automatic || !certificate.empty(); }
};

/// Returns the context of a server with these files; nullopt if the flags request no TLS. With
/// `automatic` it reads hapticast/tls.pem in the state folder, or creates it. Writes a warning to
/// `log` if other users may read the key. Throws KeyFileError.
[[nodiscard]] std::optional<TlsContext> loadServerTls(const TlsFiles& files, LimitedLog& log);

}  // namespace hapticast::server
