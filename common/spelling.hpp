// SPDX-License-Identifier: MIT
// Spelling correction by the Damerau-Levenshtein distance (optimal string alignment). Thread: any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hapticast {

/// Returns "; did you mean X?" with the nearest of `words`; empty if none is near. Near: one edit
/// for every three letters of the word (at least one), where an edit replaces, omits, adds or swaps
/// a letter.
[[nodiscard]] std::string spellingHint(std::string_view typed,
                                       const std::vector<std::string>& words);

}  // namespace hapticast
