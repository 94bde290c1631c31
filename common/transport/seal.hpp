// SPDX-License-Identifier: MIT
// Encryption of datagrams: AES-128-GCM (NIST SP 800-38D; proto/datagrams.md). A SealingKey never
// uses a counter twice: the key is random, it increments its own counter, and it cannot be copied.
// Only the .cpp of this header includes OpenSSL. Thread: any; at most one at a time for each
// object.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct evp_cipher_ctx_st;

namespace hapticast {

inline constexpr std::size_t kSealKeyBytes = 16;
inline constexpr std::size_t kSealCounterBytes = 8;
inline constexpr std::size_t kSealTagBytes = 16;
/// Bytes that a sealed datagram has in addition: counter and tag.
inline constexpr std::size_t kSealBytes = kSealCounterBytes + kSealTagBytes;
using SealKeyBytes = std::array<std::uint8_t, kSealKeyBytes>;

namespace seal_detail {
struct Free {
  void operator()(evp_cipher_ctx_st* context) const noexcept;
};
using Context = std::unique_ptr<evp_cipher_ctx_st, Free>;
}  // namespace seal_detail

/// Key with which the server seals datagrams. It can be moved, but not copied.
class SealingKey {
 public:
  /// Creates a random key with the number `id` (1..255). Throws std::runtime_error if the system
  /// has no random numbers.
  explicit SealingKey(std::uint8_t id);
  /// Creates the key `bytes`. Use it only for tests and examples, because two objects with the same
  /// bytes would use the same counters.
  SealingKey(std::uint8_t id, const SealKeyBytes& bytes);

  /// Appends the next counter, the encrypted `payload` and the tag to `head`. The bytes of `head`
  /// and the counter stay readable, but the tag protects them too. Throws std::runtime_error if
  /// OpenSSL fails.
  void seal(std::vector<std::uint8_t>& head, std::span<const std::uint8_t> payload);

  [[nodiscard]] std::uint8_t id() const noexcept { return id_; }
  [[nodiscard]] const SealKeyBytes& bytes() const noexcept { return bytes_; }

 private:
  std::uint8_t id_;
  SealKeyBytes bytes_;
  seal_detail::Context context_;
  std::uint64_t counter_ = 0;  // of the next datagram
};

/// Key with which a client opens sealed datagrams.
class OpeningKey {
 public:
  /// Throws std::runtime_error if OpenSSL fails.
  explicit OpeningKey(const SealKeyBytes& bytes);

  /// Writes the payload of `sealed` (encrypted payload and tag) to `payload` and returns true.
  /// Returns false if the tag does not match the key, the counter, `readable` (the bytes before
  /// `sealed`, counter included) and `sealed`. Then the content of `payload` is undefined. Requires
  /// a `payload` of exactly kSealTagBytes less than `sealed`.
  [[nodiscard]] bool open(std::uint64_t counter, std::span<const std::uint8_t> readable,
                          std::span<const std::uint8_t> sealed,
                          std::span<std::uint8_t> payload) const noexcept;

 private:
  seal_detail::Context context_;
};

}  // namespace hapticast
