// SPDX-License-Identifier: MIT
#include "common/transport/signature.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace hapticast {

namespace {

void require(bool done) {
  if (!done) throw std::runtime_error("OpenSSL has no Ed25519 or no random numbers");
}

template <class T>
T* checkMade(T* object) {
  require(object != nullptr);
  return object;
}

struct FreeBio {
  void operator()(BIO* bio) const noexcept { BIO_free(bio); }
};
using Bio = std::unique_ptr<BIO, FreeBio>;

}  // namespace

namespace signature_detail {
void Free::operator()(evp_md_ctx_st* context) const noexcept { EVP_MD_CTX_free(context); }
void Free::operator()(evp_pkey_st* key) const noexcept { EVP_PKEY_free(key); }
}  // namespace signature_detail

SigningKey::SigningKey(signature_detail::Key key)
    : key_(std::move(key)), context_(checkMade(EVP_MD_CTX_new())) {
  std::size_t size = verifying_key_.size();
  require(EVP_PKEY_get_raw_public_key(key_.get(), verifying_key_.data(), &size) == 1);
}

SigningKey::SigningKey()
    : SigningKey(signature_detail::Key(checkMade(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519")))) {
}

SigningKey::SigningKey(const KeyBytes& seed)
    : SigningKey(signature_detail::Key(checkMade(
          EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, seed.data(), seed.size())))) {}

Result<SigningKey> SigningKey::fromPem(std::string_view pem) {
  const Bio in(checkMade(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size()))));
  // Without this function OpenSSL would ask on the terminal.
  const auto no_password = [](char*, int, int, void*) { return -1; };
  signature_detail::Key key(PEM_read_bio_PrivateKey(in.get(), nullptr, no_password, nullptr));
  ERR_clear_error();
  if (!key || EVP_PKEY_get_id(key.get()) != EVP_PKEY_ED25519)
    return Error{"is not a private key of Ed25519 in PEM without a password"};
  return SigningKey(std::move(key));
}

std::string SigningKey::toPem() const {
  const Bio out(checkMade(BIO_new(BIO_s_secmem())));
  require(PEM_write_bio_PKCS8PrivateKey(out.get(), key_.get(), nullptr, nullptr, 0, nullptr,
                                        nullptr) == 1);
  char* text = nullptr;
  const long size = BIO_get_mem_data(out.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

Signature SigningKey::sign(std::span<const std::uint8_t> bytes) {
  Signature signature;
  std::size_t size = signature.size();
  // Initialises the context anew for each signature; its reuse saves an allocation.
  require(EVP_DigestSignInit(context_.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
          EVP_DigestSign(context_.get(), signature.data(), &size, bytes.data(), bytes.size()) == 1);
  return signature;
}

VerifyingKey::VerifyingKey(signature_detail::Key key, signature_detail::Context context) noexcept
    : key_(std::move(key)), context_(std::move(context)) {}

Result<VerifyingKey> VerifyingKey::from(std::span<const std::uint8_t> bytes) {
  const Error error{"a verifying key is not " + std::to_string(kKeyBytes) + " bytes of Ed25519"};
  if (bytes.size() != kKeyBytes) return error;
  signature_detail::Key key(
      EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, bytes.data(), bytes.size()));
  signature_detail::Context context(EVP_MD_CTX_new());
  if (!key || !context) return error;
  return VerifyingKey(std::move(key), std::move(context));
}

bool VerifyingKey::verify(std::span<const std::uint8_t> bytes,
                          std::span<const std::uint8_t> signature) const noexcept {
  return signature.size() == kSignatureBytes &&
         EVP_DigestVerifyInit(context_.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
         EVP_DigestVerify(context_.get(), signature.data(), signature.size(), bytes.data(),
                          bytes.size()) == 1;
}

std::uint64_t makeUnguessable() {
  std::uint64_t bits = 0;
  while (bits == 0) require(RAND_bytes(reinterpret_cast<unsigned char*>(&bits), sizeof bits) == 1);
  return bits;
}

}  // namespace hapticast
