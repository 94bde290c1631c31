// SPDX-License-Identifier: MIT
// The checksum of a recording in a page. hapticast's own recordings have no compression.
#include "common/recording/mcap_compression.hpp"

#include <array>

namespace hapticast {

namespace {

/// CRC-32 of each byte, by the reversed polynomial of zlib (RFC 1952, section 8).
constexpr std::array<std::uint32_t, 256> makeTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    table[byte] = crc;
  }
  return table;
}

}  // namespace

std::uint32_t computeCrc32(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  static constexpr auto kTable = makeTable();
  std::uint32_t crc = ~before;
  for (const std::uint8_t byte : bytes) crc = crc >> 8U ^ kTable[(crc ^ byte) & 255U];
  return ~crc;
}

bool canDecompress(std::string_view /*compression*/) { return false; }

bool decompress(std::string_view /*compression*/, std::span<const std::uint8_t> /*in*/,
                std::span<std::uint8_t> /*out*/) {
  return false;
}

}  // namespace hapticast
