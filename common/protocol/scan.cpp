// SPDX-License-Identifier: MIT
#include "common/protocol/scan.hpp"

#include "common/protocol/wire_reader.hpp"

namespace hapticast {

std::optional<std::vector<std::span<const std::uint8_t>>> submessages(
    std::span<const std::uint8_t> message, std::uint32_t field, std::size_t limit) {
  std::vector<std::span<const std::uint8_t>> found;
  WireReader in(message);
  std::uint32_t tag = 0;
  while (in.readTag(tag)) {
    if (numberOf(tag) != field || typeOf(tag) != WireType::kBytes) {
      if (!in.skip(tag)) break;
      continue;
    }
    std::span<const std::uint8_t> content;
    if (!in.readBytes(content)) break;
    if (found.size() == limit) return std::nullopt;
    found.push_back(content);
  }
  return found;
}

}  // namespace hapticast
