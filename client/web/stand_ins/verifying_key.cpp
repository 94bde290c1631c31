// SPDX-License-Identifier: MIT
// Signatures in a web page, which has no OpenSSL (ed25519.hpp).
#include <algorithm>
#include <utility>

#include "client/web/ed25519.hpp"
#include "common/transport/signature.hpp"

/// The key, in place of OpenSSL's.
struct evp_pkey_st {
  hapticast::KeyBytes bytes;
  hapticast::client::ed25519::Point point;
};

namespace hapticast {

namespace signature_detail {
void Free::operator()(evp_md_ctx_st* /*context*/) const noexcept {}
void Free::operator()(evp_pkey_st* key) const noexcept { delete key; }
}  // namespace signature_detail

VerifyingKey::VerifyingKey(signature_detail::Key key, signature_detail::Context context) noexcept
    : key_(std::move(key)), context_(std::move(context)) {}

Result<VerifyingKey> VerifyingKey::from(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kKeyBytes) return Error{"not a key of 32 bytes"};
  const auto point = client::ed25519::decodePoint(bytes.first<kKeyBytes>());
  if (!point) return Error{"no point of the curve"};
  signature_detail::Key key(new evp_pkey_st{{}, *point});
  std::copy(bytes.begin(), bytes.end(), key->bytes.begin());
  return VerifyingKey(std::move(key), nullptr);
}

bool VerifyingKey::verify(std::span<const std::uint8_t> bytes,
                          std::span<const std::uint8_t> signature) const noexcept {
  return signature.size() == kSignatureBytes &&
         client::ed25519::verify(bytes, signature.first<kSignatureBytes>(), key_->bytes,
                                 key_->point);
}

}  // namespace hapticast
