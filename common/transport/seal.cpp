// SPDX-License-Identifier: MIT
#include "common/transport/seal.hpp"

#include <openssl/evp.h>
#include <openssl/rand.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace hapticast {

namespace {

constexpr std::size_t kNonceBytes = 12;
using Nonce = std::array<std::uint8_t, kNonceBytes>;

void requireSeal(bool done) {
  if (!done) throw std::runtime_error("OpenSSL has no AES-128-GCM or no random numbers");
}

SealKeyBytes randomKey() {
  SealKeyBytes bytes{};
  requireSeal(RAND_priv_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1);
  return bytes;
}

/// Four zero bytes, then the counter in little-endian order, as it is in the datagram.
Nonce makeNonce(std::uint64_t counter) noexcept {
  Nonce nonce{};
  for (std::size_t i = 0; i < kSealCounterBytes; ++i)
    nonce[kNonceBytes - kSealCounterBytes + i] = static_cast<std::uint8_t>(counter >> (8 * i));
  return nonce;
}

seal_detail::Context newContext(const SealKeyBytes& key, bool encrypt) {
  seal_detail::Context context(EVP_CIPHER_CTX_new());
  requireSeal(context != nullptr && EVP_CipherInit_ex2(context.get(), EVP_aes_128_gcm(), key.data(),
                                                       nullptr, encrypt ? 1 : 0, nullptr) == 1);
  return context;
}

int sizeOf(std::span<const std::uint8_t> bytes) { return static_cast<int>(bytes.size()); }

}  // namespace

namespace seal_detail {
void Free::operator()(evp_cipher_ctx_st* context) const noexcept { EVP_CIPHER_CTX_free(context); }
}  // namespace seal_detail

SealingKey::SealingKey(std::uint8_t id) : SealingKey(id, randomKey()) {}

SealingKey::SealingKey(std::uint8_t id, const SealKeyBytes& bytes)
    : id_(id), bytes_(bytes), context_(newContext(bytes, true)) {}

void SealingKey::seal(std::vector<std::uint8_t>& head, std::span<const std::uint8_t> payload) {
  if (counter_ == std::numeric_limits<std::uint64_t>::max())
    throw std::runtime_error("a key of datagrams has no counters left");
  const Nonce nonce = makeNonce(counter_++);
  head.insert(head.end(), nonce.end() - kSealCounterBytes, nonce.end());
  const std::size_t readable = head.size();
  head.resize(readable + payload.size() + kSealTagBytes);
  std::uint8_t* const out = head.data() + readable;
  EVP_CIPHER_CTX* const context = context_.get();
  int size = 0;
  bool done =
      EVP_EncryptInit_ex2(context, nullptr, nullptr, nonce.data(), nullptr) == 1 &&
      EVP_EncryptUpdate(context, nullptr, &size, head.data(), static_cast<int>(readable)) == 1;
  if (!payload.empty())
    done = done && EVP_EncryptUpdate(context, out, &size, payload.data(), sizeOf(payload)) == 1;
  std::uint8_t* const tag = out + payload.size();
  requireSeal(done && EVP_EncryptFinal_ex(context, tag, &size) == 1 &&
              EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_AEAD_GET_TAG, kSealTagBytes, tag) == 1);
}

OpeningKey::OpeningKey(const SealKeyBytes& bytes) : context_(newContext(bytes, false)) {}

bool OpeningKey::open(std::uint64_t counter, std::span<const std::uint8_t> readable,
                      std::span<const std::uint8_t> sealed,
                      std::span<std::uint8_t> payload) const noexcept {
  if (sealed.size() != payload.size() + kSealTagBytes) return false;
  const Nonce nonce = makeNonce(counter);
  std::array<std::uint8_t, kSealTagBytes> tag{};
  std::copy(sealed.end() - kSealTagBytes, sealed.end(), tag.begin());
  EVP_CIPHER_CTX* const context = context_.get();
  int size = 0;
  bool done = EVP_DecryptInit_ex2(context, nullptr, nullptr, nonce.data(), nullptr) == 1 &&
              EVP_DecryptUpdate(context, nullptr, &size, readable.data(), sizeOf(readable)) == 1;
  if (!payload.empty())
    done = done &&
           EVP_DecryptUpdate(context, payload.data(), &size, sealed.data(), sizeOf(payload)) == 1;
  std::array<std::uint8_t, kSealTagBytes> rest{};  // GCM writes nothing here
  return done &&
         EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_AEAD_SET_TAG, kSealTagBytes, tag.data()) == 1 &&
         EVP_DecryptFinal_ex(context, rest.data(), &size) == 1;
}

}  // namespace hapticast
