// SPDX-License-Identifier: MIT
#include "client/net/origin_pin.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

std::optional<OriginKey> parseOriginKey(const std::string& text) {
  if (text == "first") return OriginKey{};
  const auto key = parseKey(text);
  if (!key) return std::nullopt;
  return OriginKey{*key};
}

OriginPin::OriginPin(std::string server, std::vector<KeyBytes> keys, Store store,
                     std::string remedy, PinKind kind)
    : accepts_all_(false),
      server_(std::move(server)),
      keys_(std::move(keys)),
      store_(std::move(store)),
      remedy_(std::move(remedy)),
      kind_(kind) {}

std::optional<std::string> OriginPin::refuse(const std::optional<KeyBytes>& key) {
  if (accepts_all_) return std::nullopt;
  if (key && std::find(keys_.begin(), keys_.end(), *key) != keys_.end()) return std::nullopt;
  if (key && store_) {
    auto stored = std::exchange(store_, nullptr)(*key);
    if (!stored.ok()) return stored.error().message;
    remedy_ = std::move(stored).value();
    keys_.push_back(*key);
    return std::nullopt;
  }
  const bool tls = kind_ == PinKind::kTls;
  return "the server at " + server_ + " shows " +
         (key ? (tls ? "the TLS key " : "the key ") + toHex(*key) : "no key") +
         ", not the expected one: somebody else may " + (tls ? "answer" : "send") +
         ", or the server has a new key" + (tls ? "" : " (--origin-key)") + remedy_;
}

}  // namespace hapticast::client
