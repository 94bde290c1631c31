// SPDX-License-Identifier: MIT
// Keys as hex digits (signature.hpp). A source of its own, because a web page has no OpenSSL.
#include <charconv>
#include <system_error>

#include "common/transport/signature.hpp"

namespace hapticast {

std::optional<KeyBytes> parseKey(std::string_view hex) {
  KeyBytes key{};
  if (hex.size() != 2 * key.size()) return std::nullopt;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const char* const digits = hex.data() + 2 * i;
    const auto [end, error] = std::from_chars(digits, digits + 2, key[i], 16);
    if (error != std::errc() || end != digits + 2) return std::nullopt;
  }
  return key;
}

std::string toHex(const KeyBytes& key) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : key) {
    hex += kDigits[byte >> 4U];
    hex += kDigits[byte & 15U];
  }
  return hex;
}

}  // namespace hapticast
