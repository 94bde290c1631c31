// SPDX-License-Identifier: MIT
#include "common/spelling.hpp"

#include <algorithm>
#include <cstddef>

namespace hapticast {

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
