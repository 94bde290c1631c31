// SPDX-License-Identifier: MIT
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

namespace hapticast {

namespace {

constexpr std::size_t kMostQuoted_bytes = 40;

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool isKey(std::string_view text) {
  return !text.empty() && text.size() <= kMaxKey_bytes && isLetter(text.front()) &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return isLetter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_';
         });
}

/// Returns whether a byte occurs in no text: a control character other than those of white space.
bool isBinary(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 && c != '\t' && c != '\n' && c != '\r';
}

std::string_view unquote(std::string_view text) {
  const bool in_quotes = text.size() >= 2 && text.front() == text.back() &&
                         (text.front() == '"' || text.front() == '\'');
  return in_quotes ? text.substr(1, text.size() - 2) : text;
}

/// First character of a text; for invalid UTF-8 one byte with code kNone.
struct Character {
  std::uint32_t code;
  std::size_t bytes;
};
constexpr std::uint32_t kNone = UINT32_MAX;

Character decodeFirst(std::string_view text) {
  const auto byte = [text](std::size_t i) -> std::uint32_t {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  if (byte(0) < 0x80) return {byte(0), 1};
  // For sequences of 2, 3 and 4 bytes: mask and mark of the first byte, and the least code of this
  // length.
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
  return std::none_of(kHidden.begin(), kHidden.end(), [code](const auto& range) {
    return code >= range.first && code <= range.second;
  });
}

/// Returns each byte as its code: \x and two hex digits.
std::string escapeBytes(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string out;
  for (const char each : bytes) {
    const auto byte = static_cast<unsigned char>(each);
    out += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
  }
  return out;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string quote(std::string_view text) {
  std::string out = "'";
  for (std::size_t used = 0; !text.empty();) {
    const Character next = decodeFirst(text);
    used += next.bytes;
    if (used > kMostQuoted_bytes) return out + "...'";
    const std::string_view bytes = text.substr(0, next.bytes);
    out += next.code != kNone && isShown(next.code) ? std::string(bytes) : escapeBytes(bytes);
    text.remove_prefix(next.bytes);
  }
  return out + "'";
}

std::string sanitizeUtf8(std::string_view text, std::size_t most_bytes) {
  std::string out;
  while (!text.empty()) {
    const Character next = decodeFirst(text);
    const bool shown = next.code != kNone && isShown(next.code);
    const std::string_view put = shown ? text.substr(0, next.bytes) : "?";
    if (out.size() + put.size() > most_bytes) break;
    out.append(put);
    text.remove_prefix(next.bytes);
  }
  return out;
}

std::string toLower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool hasEnding(std::string_view file, std::string_view ending) {
  const std::string_view name = file.substr(file.rfind('/') + 1);
  if (name.size() <= ending.size()) return false;
  return std::equal(
      ending.begin(), ending.end(), name.end() - std::ssize(ending),
      [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

std::string join(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += separator;
    text += word;
  }
  return text;
}

namespace {

/// Returns where the comment of a line begins: a `#` at its begin or behind a space.
std::size_t findComment(std::string_view line) {
  std::size_t at = line.find('#');
  while (at != std::string_view::npos && at > 0 && line[at - 1] != ' ' && line[at - 1] != '\t')
    at = line.find('#', at + 1);
  return at;
}

}  // namespace

Result<std::vector<KeyValue>> readKeyValues(std::istream& in, const std::string& name) {
  std::string text(kMaxKeyValueText_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad() || (in.gcount() == 0 && !in.eof())) {
    return Error{name + ": cannot be read"};
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxKeyValueText_bytes) {
    return Error{name + ": larger than 64 KiB"};
  }
  if (std::any_of(text.begin(), text.end(), isBinary)) {
    return Error{name + ": is not a text file; save it as plain text in UTF-8"};
  }
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of UTF-8, by some editors
  std::vector<KeyValue> pairs;
  std::string_view rest = text;
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  for (int line = 1; !rest.empty(); ++line) {
    const std::string_view whole = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(whole.size() + 1, rest.size()));
    const std::string_view content = trim(whole.substr(0, findComment(whole)));
    if (content.empty()) continue;
    const std::size_t equals = std::min(content.find('='), content.size());
    const std::string_view key = trim(content.substr(0, equals));
    if (equals == content.size() || !isKey(key)) {
      return Error{name + ":" + std::to_string(line) + ": " + quote(content) +
                   " is not a `key = value` line"};
    }
    pairs.push_back(
        {line, std::string(key), std::string(unquote(trim(content.substr(equals + 1))))});
  }
  return pairs;
}

namespace {

// Flags are shorter; a longer word is no typing error.
constexpr std::size_t kLongest = 32;

/// Damerau-Levenshtein distance (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t other = a[i - 1] == b[j - 1] ? 0 : 1;
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + other});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

}  // namespace

std::string spellingHint(std::string_view typed, const std::vector<std::string>& words) {
  if (typed.size() > kLongest) return "";
  const std::string* nearest = nullptr;
  std::size_t least = 0;
  for (const std::string& word : words) {
    const std::size_t away = distance(typed, word);
    if (away > std::max<std::size_t>(1, word.size() / 3) || away >= word.size()) continue;
    if (nearest == nullptr || away < least) {
      nearest = &word;
      least = away;
    }
  }
  return nearest == nullptr ? "" : "; did you mean " + *nearest + "?";
}

}  // namespace hapticast
