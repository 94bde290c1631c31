// SPDX-License-Identifier: MIT
// Parsing of texts from outside: numbers, UTF-8, and small files of `key = value` lines (config
// files, device profiles). The functions check limits before they parse, and they return errors as
// values. Thread: any, but not the haptic loop (allocates).
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

/// Returns `text` without white space (blank, tab, carriage return) at its begin and end.
[[nodiscard]] std::string_view trim(std::string_view text);
/// Returns `text` in quotes for an error message. Of a longer text only the first 40 bytes appear,
/// as whole characters. Each byte that is not UTF-8, and each byte of a character that controls a
/// terminal or is hidden (see sanitizeUtf8()), appears as its code, such as \x1B.
[[nodiscard]] std::string quote(std::string_view text);
/// Returns `text` with small letters in place of capital ones (ASCII).
[[nodiscard]] std::string toLower(std::string_view text);
/// Returns whether the name of the file `file` ends with `ending` (such as ".png", in small
/// letters) after at least one character. Capital letters count as small ones.
[[nodiscard]] bool hasEnding(std::string_view file, std::string_view ending);
/// Returns the words, joined with `separator`, for example "a, b, c".
[[nodiscard]] std::string join(const std::vector<std::string>& words, std::string_view separator);
/// Returns `text` as one line that cannot control a terminal. '?' replaces each byte that is not
/// UTF-8, and each control character (C0, C1). It also replaces each character that hides text or
/// changes its direction. Letters of any script are unchanged. The result has at most `most_bytes`
/// and is cut between two characters.
[[nodiscard]] std::string sanitizeUtf8(std::string_view text,
                                       std::size_t most_bytes = std::string_view::npos);
/// Returns the finite decimal number (with '.') in `text`. Returns nullopt if the whole text is not
/// such a number.
[[nodiscard]] std::optional<double> parseNumber(std::string_view text);

/// Returns the number in `text`. Returns nullopt if the whole text is not a number from `least` to
/// `most`. Number is double, std::uint16_t or std::uint64_t.
template <class Number>
[[nodiscard]] std::optional<Number> parseNumberInRange(std::string_view text, Number least,
                                                       Number most);

/// One `key = value` line.
struct KeyValue {
  int line = 0;  ///< number of the line, from 1
  std::string key;
  std::string value;
};

/// Returns the `key = value` lines of `in`, which has at most 64 KiB. `#` at the begin of a line or
/// behind a space begins a comment. A key is a letter followed by letters, digits, `-` and `_`,
/// with at most 64 bytes. A value may be in quotes. A UTF-8 byte order mark at the beginning is
/// ignored. Control characters other than tab, CR and LF are an error. The text of an error begins
/// with "NAME:LINE: ", or with "NAME: " if it concerns the whole text. NAME is `name`.
Result<std::vector<KeyValue>> readKeyValues(std::istream& in, const std::string& name);

/// Returns "; did you mean X?" with the word of `words` that is nearest to `typed`. Returns an
/// empty text if no word is near enough. The distance is the number of edits. An edit replaces,
/// omits or adds a letter, or swaps two adjacent letters. A word is near enough if its distance is
/// at most a third of its letters. A distance of 1 is near enough for a short word too. This
/// distance is the one of Damerau and Levenshtein (optimal string alignment). Thread: any.
[[nodiscard]] std::string spellingHint(std::string_view typed,
                                       const std::vector<std::string>& words);

}  // namespace hapticast
