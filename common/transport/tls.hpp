// SPDX-License-Identifier: MIT
// TLS 1.3 (RFC 8446) on OpenSSL, without sockets: a TlsEngine encrypts and decrypts the bytes of
// one connection. A TlsContext has the settings that many connections share: certificate and key of
// a server, or the authorities that a client trusts. Thread: any; at most one at a time for each
// object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/transport/signature.hpp"

struct ssl_st;
struct ssl_ctx_st;
struct bio_st;

namespace hapticast {

/// Fingerprint of a certificate's public key: SHA-256 of its SubjectPublicKeyInfo (RFC 7469). It
/// stays the same when a certificate is renewed with the same key.
using Fingerprint = KeyBytes;

/// Certificate and private key, both in PEM.
struct TlsIdentity {
  std::string certificate_pem;  ///< may contain the chain, too
  std::string key_pem;
};

/// Returns a new identity: a key of ECDSA P-256, and a self-signed certificate, valid for 20 years.
/// Only a client that has its fingerprint trusts it. Throws std::runtime_error if OpenSSL fails.
[[nodiscard]] TlsIdentity makeTlsIdentity();

namespace tls_detail {
struct Free {
  void operator()(ssl_st* connection) const noexcept;
  void operator()(ssl_ctx_st* context) const noexcept;
};
}  // namespace tls_detail

/// TLS settings of a server or of a client. Copies share one OpenSSL context.
class TlsContext {
 public:
  /// Returns the context of a server. Returns an error in one line if the texts contain no
  /// certificate with its key.
  [[nodiscard]] static Result<TlsContext> ofServer(const TlsIdentity& identity);
  /// Returns the context of a client that trusts the authorities in `ca_pem`. Returns an error in
  /// one line if the text contains no certificate.
  [[nodiscard]] static Result<TlsContext> ofClient(const std::string& ca_pem);
  /// Returns the context of a client that checks the server's fingerprint only.
  [[nodiscard]] static TlsContext ofPinningClient();

  /// Returns the fingerprint of the server's own certificate. Requires a server's context.
  [[nodiscard]] const Fingerprint& fingerprint() const { return fingerprint_; }

 private:
  friend class TlsEngine;
  explicit TlsContext(std::shared_ptr<ssl_ctx_st> context, bool server);

  std::shared_ptr<ssl_ctx_st> context_;
  bool server_ = false;
  Fingerprint fingerprint_{};
};

/// Checks the fingerprint of the server. Returns nullopt to accept it, or the reason in one line.
using FingerprintCheck = std::function<std::optional<std::string>(const Fingerprint&)>;

/// One end of a TLS connection.
class TlsEngine {
 public:
  /// Creates the server's end.
  explicit TlsEngine(const TlsContext& server);
  /// Creates the client's end, which begins the handshake. `host` is the name or address that the
  /// server's certificate must have, if the context verifies it. `check` may be empty.
  TlsEngine(const TlsContext& client, const std::string& host, FingerprintCheck check);

  /// Adds bytes from the connection, and continues the handshake. Appends decrypted bytes to
  /// `plain`. Returns an error in one line if the connection must end.
  [[nodiscard]] std::optional<Error> receive(std::span<const std::uint8_t> bytes,
                                             std::vector<std::uint8_t>& plain);
  /// Encrypts `prefix` and then `plain` for output(). It copies few bytes of `plain`, and makes no
  /// more records than needed. Returns false if the handshake is not complete, or failed. Requires
  /// a prefix of at most FramePrefix::kMostBytes bytes.
  [[nodiscard]] bool send(std::span<const std::uint8_t> prefix,
                          std::span<const std::uint8_t> plain);
  /// Adds the announcement of the connection's end (close_notify) to output().
  void finish();

  /// Returns the encrypted bytes that the caller has to send. The caller removes the bytes that it
  /// has sent.
  [[nodiscard]] std::vector<std::uint8_t>& output() { return *output_; }
  [[nodiscard]] bool established() const { return established_; }
  /// Returns whether receive() failed because this client does not trust the server.
  [[nodiscard]] bool untrusted() const { return untrusted_; }
  /// Returns whether the peer has announced the end of the connection.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  [[nodiscard]] bool encrypt(std::span<const std::uint8_t> plain);
  /// Continues the handshake with the bytes that have arrived.
  [[nodiscard]] std::optional<Error> handshake();
  [[nodiscard]] Error explain(int result);

  std::shared_ptr<ssl_ctx_st> context_;
  std::unique_ptr<ssl_st, tls_detail::Free> connection_;
  bio_st* in_ = nullptr;  // owned by connection_
  FingerprintCheck check_;
  std::unique_ptr<std::vector<std::uint8_t>> output_;  // OpenSSL appends to it
  std::size_t answers_bytes_ = 0;  // of output_, caused by messages of TLS itself
  bool established_ = false;
  bool untrusted_ = false;
  bool ended_ = false;
};

}  // namespace hapticast
