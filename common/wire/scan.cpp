// SPDX-License-Identifier: MIT
#include "common/wire/scan.hpp"

namespace hapticast {

namespace {

using Bytes = std::span<const std::uint8_t>;
enum WireType : unsigned { kVarint = 0, kFixed64 = 1, kDelimited = 2, kFixed32 = 5 };

std::optional<std::uint64_t> takeVarint(Bytes& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
    const std::uint8_t byte = bytes.front();
    bytes = bytes.subspan(1);
    value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

/// Length of the value that follows a tag.
std::optional<std::uint64_t> valueLength(unsigned wire_type, Bytes& bytes) {
  switch (wire_type) {
    case kVarint:
      return takeVarint(bytes) ? std::optional<std::uint64_t>(0) : std::nullopt;
    case kFixed64:
      return 8;
    case kDelimited:
      return takeVarint(bytes);
    case kFixed32:
      return 4;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<std::vector<Bytes>> submessages(Bytes message, std::uint32_t field,
                                              std::size_t limit) {
  std::vector<Bytes> found;
  while (!message.empty()) {
    const auto tag = takeVarint(message);
    if (!tag) break;
    const auto wire_type = static_cast<unsigned>(*tag & 7U);
    const auto length = valueLength(wire_type, message);
    if (!length || *length > message.size()) break;
    if (*tag >> 3U == field && wire_type == kDelimited) {
      if (found.size() == limit) return std::nullopt;
      found.push_back(message.first(static_cast<std::size_t>(*length)));
    }
    message = message.subspan(static_cast<std::size_t>(*length));
  }
  return found;
}

}  // namespace hapticast
