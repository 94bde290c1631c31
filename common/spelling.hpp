// SPDX-License-Identifier: MIT
// What a mistyped word may have meant. Thread: any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hapticast {

/// "; did you mean X?" with the one of `words` that is nearest to `typed`; empty when none is near:
/// for every three letters one may be wrong, missing, too many, or swapped with its neighbour.
[[nodiscard]] std::string spellingHint(std::string_view typed,
                                       const std::vector<std::string>& words);

}  // namespace hapticast
