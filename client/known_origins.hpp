// SPDX-License-Identifier: MIT
// Files with the keys that servers showed at the first connection: keys of signatures
// (--origin-key first) and TLS keys (hapticasts://), as ssh stores them. Each line
// has a server (HOST:PORT or mdns:NAME) and its key: `SERVER HEX`. Thread: main; the storing:
// network.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/net/origin_pin.hpp"

namespace hapticast::client {

/// Returns the check of the origin for the values `keys` of --origin-key. `server` names the server
/// in `file` and in messages. With `first` it reads the server's key from `file`; if the file has
/// none, the check stores the first key there. Throws std::runtime_error (one line, with the file
/// and the line's number) if the file cannot be read or has a malformed line.
[[nodiscard]] OriginPin makeOriginPin(const std::vector<OriginKey>& keys, const std::string& server,
                                      const std::filesystem::path& file);

/// Returns whether `file` has a TLS key of `server`. Throws std::runtime_error as above.
[[nodiscard]] bool knowsTlsKey(const std::string& server, const std::filesystem::path& file);

/// Returns the check of the TLS key of `server`: the first key that it shows is stored in `file`
/// and expected from then on. Throws std::runtime_error as above.
[[nodiscard]] OriginPin makeTlsPin(const std::string& server, const std::filesystem::path& file);

}  // namespace hapticast::client
