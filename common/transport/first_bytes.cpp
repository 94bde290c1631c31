// SPDX-License-Identifier: MIT
#include "common/transport/first_bytes.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace hapticast {

namespace {

bool beginsWithTls(std::span<const std::uint8_t> first) {
  constexpr std::uint8_t kHandshake = 22;  // RFC 8446, section 5.1; then a version 3.x
  return first[0] == kHandshake && first[1] == 3 && first[2] >= 1;
}

bool beginsWithHttp(std::span<const std::uint8_t> first) {
  constexpr std::string_view kGet = "GET ";
  return std::equal(kGet.begin(), kGet.end(), first.begin());
}

}  // namespace

std::optional<ConnectionKind> FirstBytes::add(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  if (bytes_.size() < kNeededBytes) return std::nullopt;
  undecided_ = false;
  if (beginsWithTls(bytes_)) return ConnectionKind::kTls;
  return beginsWithHttp(bytes_) ? ConnectionKind::kHttp : ConnectionKind::kMessages;
}

std::vector<std::uint8_t> FirstBytes::pop() { return std::exchange(bytes_, {}); }

}  // namespace hapticast
