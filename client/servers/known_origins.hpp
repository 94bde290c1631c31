// SPDX-License-Identifier: MIT
// Trust on first use, as with the known_hosts file of ssh. A file stores the key that each server
// showed at the first connection. There is one file for the keys of signatures (--origin-key
// first), and one for TLS keys (hapticasts://). Each line is `SERVER HEX`: the name of the server
// (nameServer()), and its key in hex digits.
// Thread: main. The returned pins store a new key in the network thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/net/origin_pin.hpp"

namespace hapticast::client {

/// Returns the check of the origin's key for the values `keys` of --origin-key. `server` is the
/// name of the server in `file` and in messages. If `keys` contains `first`, the pin expects the
/// key of `server` in `file`. If the file has no such key, the pin stores there the first key that
/// the server shows. Throws std::runtime_error (one line, with the file and the line's number) if
/// the file cannot be read or has a malformed line.
[[nodiscard]] OriginPin makeOriginPin(const std::vector<OriginKey>& keys, const std::string& server,
                                      const std::filesystem::path& file);

/// Returns true if `file` has a TLS key of `server`. Throws std::runtime_error as above.
[[nodiscard]] bool knowsTlsKey(const std::string& server, const std::filesystem::path& file);

/// Returns the check of the TLS key of `server`. It expects the key of `server` in `file`. If the
/// file has no such key, the pin stores there the first key that the server shows. Throws
/// std::runtime_error as above.
[[nodiscard]] OriginPin makeTlsPin(const std::string& server, const std::filesystem::path& file);

}  // namespace hapticast::client
