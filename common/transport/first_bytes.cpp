// SPDX-License-Identifier: MIT
#include "common/transport/first_bytes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace hapticast {

namespace {

bool beginsWithTls(std::span<const std::uint8_t> first) {
  constexpr std::uint8_t kHandshake = 22;  // RFC 8446, section 5.1; then a version 3.x
  return first[0] == kHandshake && first[1] == 3 && first[2] >= 1;
}

/// A method, which is a word: GET, HEAD, POST, PUT, OPTIONS. As a length prefix letters would be a
/// message of more than 500 MB.
bool beginsWithHttp(std::span<const std::uint8_t> first) {
  constexpr std::size_t kShortest = 3;
  const auto isLetter = [](std::uint8_t byte) {
    return (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z');
  };
  return std::all_of(first.begin(), first.begin() + kShortest, isLetter) &&
         (first[kShortest] == ' ' || isLetter(first[kShortest]));
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
