// SPDX-License-Identifier: MIT
#include "common/protocol/wire_reader.hpp"

namespace hapticast {

namespace {

constexpr std::size_t kLongestTag_bytes = 5;      // of 32 bits
constexpr std::size_t kLongestVarint_bytes = 10;  // of 64 bits
// libprotobuf refuses longer fields (2 GiB less a reserve).
constexpr std::uint64_t kLongestField_bytes = 0x7FFF'FFFFU - 16U;

}  // namespace

bool WireReader::read(std::size_t size, std::span<const std::uint8_t>& bytes) {
  if (size > rest_.size()) return false;
  bytes = rest_.first(size);
  rest_ = rest_.subspan(size);
  return true;
}

bool WireReader::readVarint(std::uint64_t& value) {
  value = 0;
  for (std::size_t i = 0; i < kLongestVarint_bytes && i < rest_.size(); ++i) {
    value |= std::uint64_t{rest_[i] & 127U} << (7 * i);
    if (rest_[i] > 127U) continue;
    rest_ = rest_.subspan(i + 1);
    return true;
  }
  return false;
}

bool WireReader::readTag(std::uint32_t& tag) {
  const std::size_t before = rest_.size();
  std::uint64_t value = 0;
  if (!readVarint(value) || before - rest_.size() > kLongestTag_bytes) return false;
  tag = static_cast<std::uint32_t>(value);
  return numberOf(tag) != 0;
}

bool WireReader::readBytes(std::span<const std::uint8_t>& bytes) {
  const std::size_t before = rest_.size();
  std::uint64_t size = 0;
  if (!readVarint(size) || before - rest_.size() > kLongestTag_bytes) return false;
  return size <= kLongestField_bytes && read(static_cast<std::size_t>(size), bytes);
}

bool WireReader::skip(std::uint32_t tag) {
  std::uint64_t number = 0;
  std::span<const std::uint8_t> bytes;
  switch (typeOf(tag)) {
    case WireType::kVarint:
      return readVarint(number);
    case WireType::kFixed64:
      return read(8, bytes);
    case WireType::kBytes:
      return readBytes(bytes);
    case WireType::kBeginGroup:
      return skipGroup(numberOf(tag));
    case WireType::kFixed32:
      return read(4, bytes);
    case WireType::kEndGroup:
      break;
  }
  return false;
}

bool WireReader::skipGroup(std::uint32_t number) {
  if (depth_ == 0) return false;
  --depth_;
  std::uint32_t tag = 0;
  while (readTag(tag)) {
    if (typeOf(tag) == WireType::kEndGroup) {
      ++depth_;
      return numberOf(tag) == number;
    }
    if (!skip(tag)) return false;
  }
  return false;
}

void WireWriter::varint(std::uint64_t value) {
  for (; value > 127U; value >>= 7U) bytes_ += static_cast<char>(value | 128U);
  bytes_ += static_cast<char>(value);
}

bool isUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<std::uint8_t>(text[i]);
    std::size_t more = 0;
    if (first >= 0xF0)
      more = 3;
    else if (first >= 0xE0)
      more = 2;
    else if (first >= 0xC0)
      more = 1;
    else if (first >= 0x80)
      return false;
    if (first > 0xF4 || more >= text.size() - i) return false;
    std::uint32_t code = more == 0 ? first : first & (0x3FU >> more);
    for (std::size_t k = 1; k <= more; ++k) {
      const auto byte = static_cast<std::uint8_t>(text[i + k]);
      if ((byte & 0xC0U) != 0x80U) return false;
      code = code << 6U | (byte & 0x3FU);
    }
    constexpr std::uint32_t kLeast[] = {0, 0x80, 0x800, 0x1'0000};  // no longer form than needed
    if (code < kLeast[more] || code > 0x10'FFFF || (code >= 0xD800 && code <= 0xDFFF)) return false;
    i += more + 1;
  }
  return true;
}

}  // namespace hapticast
