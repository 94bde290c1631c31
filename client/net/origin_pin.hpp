// SPDX-License-Identifier: MIT
// Check of a server's public key (key pinning): the client accepts only servers with an expected
// key, either the key of the origin's signatures (--origin-key) or the key of TLS. The code uses no
// files and no sockets. Thread: network; the creation: any.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {

/// One value of --origin-key.
struct OriginKey {
  /// The expected key. nullopt: the key that the server shows at the first connection (trust on
  /// first use).
  std::optional<KeyBytes> key;
  bool operator==(const OriginKey&) const = default;
};

/// Returns the value of --origin-key in `text`: 64 hex digits, or the word `first`. Returns nullopt
/// for other texts.
[[nodiscard]] std::optional<OriginKey> parseOriginKey(const std::string& text);

/// Kind of key that a pin expects.
enum class PinKind : std::uint8_t {
  kOrigin,  ///< key of the signatures (--origin-key)
  kTls,     ///< fingerprint of the TLS certificate (hapticasts://)
};

/// Decides which servers the client accepts, by their keys.
class OriginPin {
 public:
  /// Stores the first key that the server shows. Returns the remedy for a later refusal, which
  /// states where the key is stored. Returns an error (one line) if the key cannot be stored.
  using Store = std::function<Result<std::string>(const KeyBytes&)>;

  /// Accepts every server.
  OriginPin() = default;
  /// Accepts servers with one of `keys`. If `store` is not empty, also accepts the first other key
  /// that the server shows, stores it, and from then on accepts that key. `server` names the server
  /// in messages. `remedy` is appended to the text of a refusal.
  OriginPin(std::string server, std::vector<KeyBytes> keys, Store store = nullptr,
            std::string remedy = "", PinKind kind = PinKind::kOrigin);

  /// Returns nullopt if the client accepts a server with `key` (nullopt: the server shows no key).
  /// Otherwise returns the reason in one line.
  [[nodiscard]] std::optional<std::string> refuse(const std::optional<KeyBytes>& key);

 private:
  bool accepts_all_ = true;
  std::string server_;
  std::vector<KeyBytes> keys_;
  Store store_;
  std::string remedy_;
  PinKind kind_ = PinKind::kOrigin;
};

}  // namespace hapticast::client
