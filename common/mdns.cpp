// SPDX-License-Identifier: MIT
#include "common/mdns.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "common/text.hpp"

namespace hapticast {

namespace {

bool isShown(std::uint32_t code) {
  // Controls, soft hyphen, directional marks, line separators, invisible joiners, tags.
  constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 10> kHidden{{{0x00, 0x1F},
                                                                             {0x7F, 0x9F},
                                                                             {0xAD, 0xAD},
                                                                             {0x061C, 0x061C},
                                                                             {0x200B, 0x200B},
                                                                             {0x200E, 0x200F},
                                                                             {0x2028, 0x202E},
                                                                             {0x2060, 0x206F},
                                                                             {0xFEFF, 0xFEFF},
                                                                             {0xE0000, 0xE0FFF}}};
  return std::none_of(kHidden.begin(), kHidden.end(), [code](const auto& range) {
    return code >= range.first && code <= range.second;
  });
}

}  // namespace

std::string printable(std::string_view text, std::size_t most_bytes) {
  return sanitizeUtf8(text, most_bytes, isShown);
}

bool isServiceName(std::string_view text) {
  return !text.empty() && printable(text, kMaxServiceName_bytes) == text;
}

}  // namespace hapticast
