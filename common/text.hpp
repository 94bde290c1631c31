// SPDX-License-Identifier: MIT
// Parsing of text from outside: numbers, UTF-8, and small files of `key = value` lines (config
// files, device profiles). Checks limits first, returns typed errors. Thread: any, but not the
// haptic loop (allocates).
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

/// Returns `text` without white space (blank, tab, carriage return) at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Returns `text` in quotes, cut after 40 bytes, for error messages.
[[nodiscard]] std::string quote(std::string_view text);
/// Joins the words with `separator`, for example "a, b, c".
[[nodiscard]] std::string join(const std::vector<std::string>& words, std::string_view separator);
/// Returns `text` as one line that cannot control a terminal. '?' replaces each byte outside UTF-8,
/// each control character (C0, C1), and each character that hides text or changes its direction.
/// Letters of any script stay. Cuts to `most_bytes` between two characters.
[[nodiscard]] std::string sanitizeUtf8(std::string_view text,
                                       std::size_t most_bytes = std::string_view::npos);
/// Parses a finite decimal number (with '.') that is the whole of `text`; nullopt for other texts.
[[nodiscard]] std::optional<double> parseNumber(std::string_view text);

/// Parses a number from `least` to `most` that is the whole of `text`; nullopt for other texts. For
/// double, std::uint16_t and std::uint64_t.
template <class Number>
[[nodiscard]] std::optional<Number> parseNumberInRange(std::string_view text, Number least,
                                                       Number most);

/// One `key = value` line.
struct KeyValue {
  int line = 0;  ///< counts from 1
  std::string key;
  std::string value;
};

/// Reads `key = value` lines of at most 64 KiB. `#` begins a comment. A key is a letter followed by
/// letters, digits, `-` and `_`, at most 64 bytes. A value may be in quotes. Errors begin with
/// `name`: "NAME:LINE: ...".
Result<std::vector<KeyValue>> readKeyValues(std::istream& in, const std::string& name);

// Spelling correction by the Damerau-Levenshtein distance (optimal string alignment). Thread: any.

/// Returns "; did you mean X?" with the nearest of `words`; empty if none is near. Near: one edit
/// for every three letters of the word (at least one), where an edit replaces, omits, adds or swaps
/// a letter.
[[nodiscard]] std::string spellingHint(std::string_view typed,
                                       const std::vector<std::string>& words);

}  // namespace hapticast
