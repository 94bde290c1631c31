// SPDX-License-Identifier: MIT
// Text from outside: numbers, and small files of `key = value` lines (config files, device
// profiles). Limits first, typed errors. Thread: any, not the loop's (allocates).
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace hapticast {

inline constexpr std::size_t kMaxKeyValueText_bytes = 65'536;
inline constexpr std::size_t kMaxKey_bytes = 64;

/// Without the white space at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// In quotes, cut after 40 bytes: what an error message says of a wrong value.
[[nodiscard]] std::string quote(std::string_view text);
/// "a, b, c" with the separator ", ".
[[nodiscard]] std::string join(const std::vector<std::string>& words, std::string_view separator);
/// Returns `text` as one line that cannot steer a terminal. '?' replaces each byte outside UTF-8,
/// each control character (C0, C1), and each character that hides text or changes its direction.
/// Letters of any script stay. Cuts to `most_bytes` between two characters.
[[nodiscard]] std::string sanitizeUtf8(std::string_view text,
                                       std::size_t most_bytes = std::string_view::npos);
/// A finite number that is the whole of `text` (decimal, '.'); nullopt otherwise.
[[nodiscard]] std::optional<double> parseNumber(std::string_view text);

/// The number from `least` to `most` that is the whole of `text`; nullopt otherwise. For double,
/// std::uint16_t and std::uint64_t.
template <class Number>
[[nodiscard]] std::optional<Number> parseNumberInRange(std::string_view text, Number least,
                                                       Number most);

struct KeyValue {
  int line = 0;  ///< 1 is the first
  std::string key;
  std::string value;
};

/// The `key = value` lines of at most 64 KiB. `#` begins a comment; a key is a letter and then
/// letters, digits, `-` and `_`, at most 64; a value may stand in a pair of quotes. Error messages
/// begin with `name`: "NAME:LINE: ...".
Result<std::vector<KeyValue>> readKeyValues(std::istream& in, const std::string& name);

}  // namespace hapticast
