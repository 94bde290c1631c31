// SPDX-License-Identifier: MIT
// Reads a study from a JSON file (README.md, "Study file"). The text is not trusted.
// Thread: any.
#pragma once

#include <string>
#include <string_view>

#include "client/study/study.hpp"

namespace hapticast::client {

/// Most trials of a subject. Chosen: a day of trials of 10 s.
inline constexpr std::size_t kMostTrials = 5000;

/// Returns the study in `text`. Throws JsonError.
[[nodiscard]] Study parseStudy(std::string_view text);
/// Returns the content of `file`. Throws std::runtime_error with one line that names the file.
[[nodiscard]] std::string readStudyText(const std::string& file);

}  // namespace hapticast::client
