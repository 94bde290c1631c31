// SPDX-License-Identifier: MIT
#include "common/transport/tls.hpp"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace hapticast {

namespace {

// A record has at most 16 KiB of plain bytes (RFC 8446, section 5.1).
constexpr std::size_t kRecordBytes = 16U << 10U;
constexpr std::size_t kMostAnswers_bytes = 4096;  // chosen: that wait for the connection

struct FreeTlsPart {
  void operator()(X509* certificate) const noexcept { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const noexcept { EVP_PKEY_free(key); }
  void operator()(BIO* bytes) const noexcept { BIO_free_all(bytes); }
};
template <class Part>
using TlsPart = std::unique_ptr<Part, FreeTlsPart>;

TlsPart<BIO> readText(const std::string& text) {
  return TlsPart<BIO>(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

std::string writeText(const auto& write) {
  const TlsPart<BIO> bytes(BIO_new(BIO_s_mem()));
  if (bytes == nullptr || write(bytes.get()) != 1) throw std::runtime_error("OpenSSL failed");
  char* data = nullptr;
  const long size = BIO_get_mem_data(bytes.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

/// A password would block the program with a question.
int refusePassword(char*, int, int, void*) { return -1; }

Fingerprint computeFingerprint(const X509* certificate) {
  Fingerprint digest{};
  unsigned char* spki = nullptr;
  const int size = i2d_X509_PUBKEY(X509_get_X509_PUBKEY(certificate), &spki);
  if (size > 0) SHA256(spki, static_cast<std::size_t>(size), digest.data());
  OPENSSL_free(spki);
  return digest;
}

std::shared_ptr<SSL_CTX> makeContext(const SSL_METHOD* method) {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(method), tls_detail::Free{});
  if (context == nullptr) throw std::runtime_error("OpenSSL failed");
  SSL_CTX_set_min_proto_version(context.get(), TLS1_3_VERSION);
  SSL_CTX_set_mode(context.get(), SSL_MODE_RELEASE_BUFFERS);
  // AES-128 first, as for sealed datagrams: it needs 10 rounds where AES-256 needs 14. A client
  // without AES in hardware asks for ChaCha20.
  SSL_CTX_set_ciphersuites(
      context.get(), "TLS_AES_128_GCM_SHA256:TLS_AES_256_GCM_SHA384:TLS_CHACHA20_POLY1305_SHA256");
  SSL_CTX_set_options(context.get(), SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_PRIORITIZE_CHACHA);
  SSL_CTX_set_num_tickets(context.get(), 0);  // each connection begins anew
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  return context;
}

/// Adds all certificates of `pem` with `add`. Returns their number.
int readCertificates(const std::string& pem, const auto& add) {
  const TlsPart<BIO> text = readText(pem);
  int count = 0;
  while (TlsPart<X509> each{PEM_read_bio_X509(text.get(), nullptr, refusePassword, nullptr)}) {
    add(std::move(each), count);
    ++count;
  }
  ERR_clear_error();
  return count;
}

TlsPart<X509> signCertificate(EVP_PKEY* key) {
  constexpr long kValid_s = 20L * 365 * 24 * 3600;
  TlsPart<X509> certificate(X509_new());
  std::array<unsigned char, 8> serial{};
  if (certificate == nullptr || RAND_bytes(serial.data(), serial.size()) != 1)
    throw std::runtime_error("OpenSSL failed");
  serial[0] &= 0x7FU;
  BIGNUM* number = BN_bin2bn(serial.data(), serial.size(), nullptr);
  BN_to_ASN1_INTEGER(number, X509_get_serialNumber(certificate.get()));
  BN_free(number);
  X509_set_version(certificate.get(), X509_VERSION_3);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -24L * 3600);  // clocks may differ
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), kValid_s);
  X509_NAME* name = X509_get_subject_name(certificate.get());
  constexpr std::array<unsigned char, 10> kName{'h', 'a', 'p', 't', 'i', 'c', 'a', 's', 't', 0};
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, kName.data(), -1, -1, 0);
  X509_set_issuer_name(certificate.get(), name);
  X509_set_pubkey(certificate.get(), key);
  if (X509_sign(certificate.get(), key, EVP_sha256()) == 0)
    throw std::runtime_error("OpenSSL failed");
  return certificate;
}

/// Appends encrypted bytes to the output of a TlsEngine.
int appendOutput(BIO* to, const char* bytes, int size) {
  auto& output = *static_cast<std::vector<std::uint8_t>*>(BIO_get_data(to));
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(bytes);  // else byte by byte
  output.insert(output.end(), begin, begin + size);
  return size;
}

long controlOutput(BIO*, int command, long, void*) { return command == BIO_CTRL_FLUSH ? 1 : 0; }

/// Returns a sink of OpenSSL that appends to `output`. OpenSSL's own sink would store the bytes
/// once more.
BIO* makeOutput(std::vector<std::uint8_t>& output) {
  static BIO_METHOD* const method = [] {
    BIO_METHOD* const made = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "output");
    if (made == nullptr) throw std::runtime_error("OpenSSL failed");
    BIO_meth_set_write(made, appendOutput);
    BIO_meth_set_ctrl(made, controlOutput);
    return made;
  }();
  BIO* const made = BIO_new(method);
  if (made == nullptr) throw std::runtime_error("OpenSSL failed");
  BIO_set_data(made, &output);
  BIO_set_init(made, 1);
  return made;
}

}  // namespace

void tls_detail::Free::operator()(ssl_st* connection) const noexcept { SSL_free(connection); }
void tls_detail::Free::operator()(ssl_ctx_st* context) const noexcept { SSL_CTX_free(context); }

TlsIdentity makeTlsIdentity() {
  const TlsPart<EVP_PKEY> key(EVP_EC_gen("P-256"));
  if (key == nullptr) throw std::runtime_error("OpenSSL failed");
  const TlsPart<X509> certificate = signCertificate(key.get());
  return {writeText([&](BIO* to) { return PEM_write_bio_X509(to, certificate.get()); }),
          writeText([&](BIO* to) {
            return PEM_write_bio_PKCS8PrivateKey(to, key.get(), nullptr, nullptr, 0, nullptr,
                                                 nullptr);
          })};
}

TlsContext::TlsContext(std::shared_ptr<ssl_ctx_st> context, bool server)
    : context_(std::move(context)), server_(server) {}

Result<TlsContext> TlsContext::ofServer(const TlsIdentity& identity) {
  TlsContext out(makeContext(TLS_server_method()), true);
  SSL_CTX* const context = out.context_.get();
  const int count = readCertificates(identity.certificate_pem, [&](TlsPart<X509> each, int index) {
    if (index == 0) {
      out.fingerprint_ = computeFingerprint(each.get());
      SSL_CTX_use_certificate(context, each.get());
    } else if (SSL_CTX_add0_chain_cert(context, each.get()) == 1) {
      (void)each.release();  // the context owns it
    }
  });
  if (count == 0) return Error{"holds no certificate in PEM"};
  const TlsPart<BIO> text = readText(identity.key_pem);
  const TlsPart<EVP_PKEY> key(
      PEM_read_bio_PrivateKey(text.get(), nullptr, refusePassword, nullptr));
  const bool usable = key != nullptr && SSL_CTX_use_PrivateKey(context, key.get()) == 1 &&
                      SSL_CTX_check_private_key(context) == 1;
  ERR_clear_error();
  if (key == nullptr) return Error{"holds no private key in PEM without a password"};
  if (!usable) return Error{"is not the private key of the certificate"};
  return out;
}

Result<TlsContext> TlsContext::ofClient(const std::string& ca_pem) {
  TlsContext out(makeContext(TLS_client_method()), false);
  X509_STORE* const store = SSL_CTX_get_cert_store(out.context_.get());
  const int count = readCertificates(
      ca_pem, [&](const TlsPart<X509>& each, int) { X509_STORE_add_cert(store, each.get()); });
  if (count == 0) return Error{"holds no certificate in PEM"};
  SSL_CTX_set_verify(out.context_.get(), SSL_VERIFY_PEER, nullptr);
  return out;
}

TlsContext TlsContext::ofPinningClient() {
  return TlsContext(makeContext(TLS_client_method()), false);
}

TlsEngine::TlsEngine(const TlsContext& server)
    : context_(server.context_), output_(std::make_unique<std::vector<std::uint8_t>>()) {
  connection_.reset(SSL_new(context_.get()));
  in_ = BIO_new(BIO_s_mem());
  if (connection_ == nullptr || in_ == nullptr) throw std::runtime_error("OpenSSL failed");
  BIO_set_mem_eof_return(in_, -1);  // more bytes follow
  SSL_set_bio(connection_.get(), in_, makeOutput(*output_));
  if (server.server_) SSL_set_accept_state(connection_.get());
}

TlsEngine::TlsEngine(const TlsContext& client, const std::string& host, FingerprintCheck check)
    : TlsEngine(client) {
  check_ = std::move(check);
  SSL* const connection = connection_.get();
  SSL_set_connect_state(connection);
  X509_VERIFY_PARAM* const expected = SSL_get0_param(connection);
  const bool is_address = X509_VERIFY_PARAM_set1_ip_asc(expected, host.c_str()) == 1;
  if (!is_address) {
    SSL_set1_host(connection, host.c_str());
    SSL_set_tlsext_host_name(connection, host.c_str());
  }
  (void)handshake();  // the first flight cannot fail
}

Error TlsEngine::explain(int result) {
  const int kind = SSL_get_error(connection_.get(), result);
  const unsigned long code = ERR_peek_last_error();
  std::array<char, 256> text{};
  ERR_error_string_n(code, text.data(), text.size());
  const long verified = SSL_get_verify_result(connection_.get());
  ERR_clear_error();
  if (verified != X509_V_OK && SSL_get_verify_mode(connection_.get()) != SSL_VERIFY_NONE) {
    untrusted_ = true;
    std::string why = X509_verify_cert_error_string(verified);
    const bool of_time =
        verified == X509_V_ERR_CERT_NOT_YET_VALID || verified == X509_V_ERR_CERT_HAS_EXPIRED;
    if (of_time) why += ", by the clock of this machine";
    return Error{"the server's certificate is not valid: " + why};
  }
  const char* reason = ERR_reason_error_string(code);
  if (kind == SSL_ERROR_SSL && reason != nullptr)
    return Error{std::string("TLS failed: ") + reason};
  return Error{"TLS failed"};
}

std::optional<Error> TlsEngine::handshake() {
  if (established_) return std::nullopt;
  const int result = SSL_do_handshake(connection_.get());
  if (result != 1) {
    if (SSL_get_error(connection_.get(), result) == SSL_ERROR_WANT_READ) return std::nullopt;
    return explain(result);
  }
  if (check_) {
    const std::unique_ptr<X509, FreeTlsPart> peer(SSL_get1_peer_certificate(connection_.get()));
    if (peer == nullptr) return Error{"the server shows no certificate"};
    if (auto refusal = check_(computeFingerprint(peer.get()))) {
      untrusted_ = true;
      return Error{std::move(*refusal)};
    }
  }
  established_ = true;
  return std::nullopt;
}

std::optional<Error> TlsEngine::receive(std::span<const std::uint8_t> bytes,
                                        std::vector<std::uint8_t>& plain) {
  ERR_clear_error();
  std::size_t written = 0;
  const std::size_t waited = output_->size();
  if (waited == 0) answers_bytes_ = 0;  // all earlier answers have been sent
  if (!bytes.empty() && BIO_write_ex(in_, bytes.data(), bytes.size(), &written) != 1)
    return Error{"TLS failed: out of memory"};
  if (auto failure = handshake()) return failure;
  if (!established_) return std::nullopt;
  for (;;) {
    const std::size_t before = plain.size();
    plain.resize(before + kRecordBytes);
    std::size_t read = 0;
    const int result = SSL_read_ex(connection_.get(), plain.data() + before, kRecordBytes, &read);
    plain.resize(before + read);
    if (result == 1) continue;
    const int why = SSL_get_error(connection_.get(), result);
    // A peer may request new keys again and again, without reading the answers.
    answers_bytes_ += output_->size() - waited;
    if (answers_bytes_ > kMostAnswers_bytes) return Error{"TLS failed: too many messages"};
    if (why == SSL_ERROR_WANT_READ) return std::nullopt;
    if (why != SSL_ERROR_ZERO_RETURN) return explain(result);
    ended_ = true;
    return std::nullopt;
  }
}

bool TlsEngine::encrypt(std::span<const std::uint8_t> plain) {
  std::size_t written = 0;
  return plain.empty() ||
         SSL_write_ex(connection_.get(), plain.data(), plain.size(), &written) == 1;
}

bool TlsEngine::send(std::span<const std::uint8_t> prefix, std::span<const std::uint8_t> plain) {
  if (!established_) return false;
  ERR_clear_error();
  // A record of its own for the prefix would cost a viewer 22 bytes and a second encryption. So the
  // first record has the prefix and the bytes that fill no whole record. OpenSSL reads the rest
  // where it is.
  const std::size_t all = prefix.size() + plain.size();
  const std::size_t first = all == 0 ? 0 : (all - 1) % kRecordBytes + 1;
  std::array<std::uint8_t, kRecordBytes> record;  // not initialised: it is large
  const std::size_t copied = std::max(first, prefix.size()) - prefix.size();
  const auto end = std::copy(prefix.begin(), prefix.end(), record.begin());
  std::copy_n(plain.begin(), copied, end);
  return encrypt(std::span(record).first(prefix.size() + copied)) && encrypt(plain.subspan(copied));
}

void TlsEngine::finish() {
  if (!established_) return;
  (void)SSL_shutdown(connection_.get());
  ERR_clear_error();
}

}  // namespace hapticast
