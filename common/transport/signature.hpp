// SPDX-License-Identifier: MIT
// Ed25519 signatures (RFC 8032) and random numbers. This header does not include OpenSSL. Only its
// .cpp file does. Thread: any; at most one at a time for each object. Functions with "Thread: any"
// have no such limit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/result.hpp"

struct evp_md_ctx_st;
struct evp_pkey_st;

namespace hapticast {

inline constexpr std::size_t kSignatureBytes = 64;
inline constexpr std::size_t kKeyBytes = 32;
using Signature = std::array<std::uint8_t, kSignatureBytes>;
using KeyBytes = std::array<std::uint8_t, kKeyBytes>;

/// Returns the key in `hex`, 64 hex digits. Returns nullopt for other texts. Thread: any.
[[nodiscard]] std::optional<KeyBytes> parseKey(std::string_view hex);
/// Returns the 64 hex digits of `key`, in small letters. Thread: any.
[[nodiscard]] std::string toHex(const KeyBytes& key);

namespace signature_detail {
struct Free {
  void operator()(evp_md_ctx_st* context) const noexcept;
  void operator()(evp_pkey_st* key) const noexcept;
};
using Key = std::unique_ptr<evp_pkey_st, Free>;
using Context = std::unique_ptr<evp_md_ctx_st, Free>;
}  // namespace signature_detail

/// Secret key, with which the server signs.
class SigningKey {
 public:
  /// Creates a random key. Throws std::runtime_error if the system has no random numbers.
  SigningKey();
  /// Creates the key that RFC 8032 defines for `seed`. It serves for tests and examples.
  explicit SigningKey(const KeyBytes& seed);

  /// Returns the key in `pem`, a private key in PEM (PKCS#8). Returns an error if the text has no
  /// such key of Ed25519, or if the key has a password.
  [[nodiscard]] static Result<SigningKey> fromPem(std::string_view pem);
  /// Returns the key in PEM (PKCS#8). The text is as secret as the key. Throws std::runtime_error
  /// if OpenSSL fails.
  [[nodiscard]] std::string toPem() const;

  /// Returns the signature of `bytes`. Throws std::runtime_error if OpenSSL fails.
  [[nodiscard]] Signature sign(std::span<const std::uint8_t> bytes);
  [[nodiscard]] const KeyBytes& verifyingKey() const noexcept { return verifying_key_; }

 private:
  explicit SigningKey(signature_detail::Key key);

  signature_detail::Key key_;
  signature_detail::Context context_;
  KeyBytes verifying_key_{};
};

/// Public key, with which a client verifies signatures.
class VerifyingKey {
 public:
  /// Returns the key in `bytes`. Returns an error if they are not a key of 32 bytes.
  [[nodiscard]] static Result<VerifyingKey> from(std::span<const std::uint8_t> bytes);

  /// Returns true if `signature` is the signature of exactly these `bytes` by the owner of the key.
  [[nodiscard]] bool verify(std::span<const std::uint8_t> bytes,
                            std::span<const std::uint8_t> signature) const noexcept;

 private:
  VerifyingKey(signature_detail::Key key, signature_detail::Context context) noexcept;

  signature_detail::Key key_;
  signature_detail::Context context_;
};

/// Returns 64 unpredictable random bits. The result is never 0. Throws std::runtime_error
/// if the system has no random numbers. Thread: any.
[[nodiscard]] std::uint64_t makeUnguessable();

}  // namespace hapticast
