// SPDX-License-Identifier: MIT
#include "common/service.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace hapticast {

namespace {

/// A character at the front of a text; none of UTF-8: one byte of code kNone.
struct Character {
  std::uint32_t code;
  std::size_t bytes;
};
constexpr std::uint32_t kNone = UINT32_MAX;

Character frontOf(std::string_view text) {
  const auto byte = [text](std::size_t i) -> std::uint32_t {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  if (byte(0) < 0x80) return {byte(0), 1};
  // Of 2, 3 and 4 bytes: the first one's mark, and the least code that needs so many.
  constexpr std::array<std::array<std::uint32_t, 3>, 3> kForms{
      {{0xE0, 0xC0, 0x80}, {0xF0, 0xE0, 0x800}, {0xF8, 0xF0, 0x10000}}};
  for (std::size_t more = 1; more <= kForms.size(); ++more) {
    const auto& [mask, mark, least] = kForms[more - 1];
    if ((byte(0) & mask) != mark) continue;
    std::uint32_t code = byte(0) & ~mask & 0xFF;
    for (std::size_t i = 1; i <= more; ++i) {
      if ((byte(i) & 0xC0) != 0x80) return {kNone, 1};
      code = code << 6 | (byte(i) & 0x3F);
    }
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < least || code > 0x10FFFF || surrogate) return {kNone, 1};
    return {code, more + 1};
  }
  return {kNone, 1};
}

bool isShown(std::uint32_t code) {
  // Controls, soft hyphen, marks of direction, what separates lines or joins invisibly, tags.
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
  return code != kNone && std::none_of(kHidden.begin(), kHidden.end(), [code](const auto& range) {
           return code >= range.first && code <= range.second;
         });
}

}  // namespace

std::string printable(std::string_view text, std::size_t most_bytes) {
  std::string out;
  while (!text.empty()) {
    const Character next = frontOf(text);
    const std::string_view shown = isShown(next.code) ? text.substr(0, next.bytes) : "?";
    if (out.size() + shown.size() > most_bytes) break;
    out.append(shown);
    text.remove_prefix(next.bytes);
  }
  return out;
}

bool isServiceName(std::string_view text) {
  return !text.empty() && printable(text, kMaxServiceName_bytes) == text;
}

}  // namespace hapticast
