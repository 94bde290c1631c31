// SPDX-License-Identifier: MIT
// Result files: pictures, previews. Thread: any, but not the haptic loop (waits for the disk).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "common/result.hpp"

namespace hapticast {

/// Writes `bytes` to `file`. Returns an error without the file's name ("cannot be written (...)")
/// and removes the incomplete file if that fails, otherwise nullopt.
[[nodiscard]] std::optional<Error> writeFile(const std::string& file,
                                             std::span<const unsigned char> bytes);

/// Checks before a run that `file` can be written after the run. An empty name is always valid.
/// Throws std::runtime_error with one line, which names `flag` and `file`.
void requireWritable(const char* flag, const std::string& file);

}  // namespace hapticast
