// SPDX-License-Identifier: MIT
// Decides on the first bytes of a connection what it carries, so that one port serves clients of
// every kind. No two kinds can begin with the same bytes: the method of a request as a length
// prefix would be a message of more than 500 MB, and a TLS record as a length prefix one of more
// than 64 KiB. Thread: any; at most one at a time for each object.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hapticast {

/// What a connection carries.
enum class ConnectionKind : std::uint8_t {
  kMessages,  ///< messages with a length prefix; also anything that is no other kind
  kTls,
  kHttp,  ///< a request of HTTP, or text
};

/// Stores the first bytes of a connection until they decide.
class FirstBytes {
 public:
  /// Number of bytes that decide: a length prefix.
  static constexpr std::size_t kNeededBytes = 4;

  /// `undecided`: the bytes decide the kind. If it is false, the kind is known.
  explicit FirstBytes(bool undecided) : undecided_(undecided) {}

  [[nodiscard]] bool undecided() const { return undecided_; }
  /// Adds bytes. Returns the kind of the connection once enough bytes have arrived, else nullopt.
  /// Requires undecided().
  [[nodiscard]] std::optional<ConnectionKind> add(std::span<const std::uint8_t> bytes);
  /// Returns all bytes that were added, and forgets them. Call it after the decision.
  [[nodiscard]] std::vector<std::uint8_t> pop();

 private:
  bool undecided_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace hapticast
