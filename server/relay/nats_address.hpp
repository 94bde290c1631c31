// SPDX-License-Identifier: MIT
// Address of a channel on NATS: nats://[USER:PASSWORD@]HOST[:PORT][,HOST2[:PORT]]/CHANNEL. Thread:
// any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/endpoint.hpp"

namespace hapticast::server {

inline constexpr std::uint16_t kNatsPort = 4222;  // the standard port of nats-server
inline constexpr std::string_view kNatsScheme = "nats://";
/// Form of an address, for messages to the user.
inline constexpr const char* kNatsForm =
    "nats://[USER:PASSWORD@]HOST[:PORT][,HOST2[:PORT]]/CHANNEL";

/// Servers of one NATS system, and a channel on it.
struct NatsAddress {
  std::vector<Endpoint> servers;  ///< at least one; the connection uses one of them
  std::string channel;
  /// User of all servers; without a password it is a token, as NATS defines it. Empty: none.
  std::string user;
  std::optional<std::string> password;

  bool operator==(const NatsAddress&) const = default;
};

inline constexpr std::size_t kMostChannelBytes = 64;

/// Returns whether `name` may be the name of a channel: 1 to 64 letters, digits, '-' and '_'.
[[nodiscard]] bool isChannelName(std::string_view name);
/// Returns the address in `text`. Returns nullopt for other texts. User and password may have
/// percent-encoded characters, for example %40 for '@'.
[[nodiscard]] std::optional<NatsAddress> parseNatsAddress(std::string_view text);
/// Returns the text of the address, without user and password.
[[nodiscard]] std::string toString(const NatsAddress& address);

/// Returns `text`, a part of the command line, without user and password: for messages about an
/// address that is not valid.
[[nodiscard]] std::string hideUser(std::string_view text);

/// Credentials for NATS (--nats-creds, --nats-ca).
struct NatsCredentials {
  std::string creds_file;  ///< file with JWT and NKey seed; empty: none
  std::string ca_file;     ///< certificates of the authorities for TLS; empty: no TLS
};

}  // namespace hapticast::server
