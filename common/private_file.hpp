// SPDX-License-Identifier: MIT
// Small files that only their owner may read: keys, and data that a program keeps between its runs.
// Thread: any, but not the haptic loop (allocates, waits for the disk).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"

namespace hapticast {

/// Largest file that readSmallFile() accepts. The value is a choice: such files have a few lines.
inline constexpr std::size_t kMaxSmallFile_bytes = 1U << 20U;

/// Returns the folder for data that a program keeps between its runs: $STATE_DIRECTORY (set by
/// systemd), or hapticast in $XDG_STATE_HOME, or in ~/.local/state. It may not exist yet.
[[nodiscard]] std::filesystem::path stateFolder();

/// Returns the content of `file`. Returns an error without the file's name ("cannot be read (...)")
/// if the file is larger than kMaxSmallFile_bytes, is no regular file, or cannot be read.
[[nodiscard]] Result<std::string> readSmallFile(const std::filesystem::path& file);

/// Writes `text` to `file` with the mode 0600, and creates its folder. The replacement is atomic:
/// at any time the file has either the old text or the new one, also after a crash. Returns an
/// error without the file's name ("cannot be written (...)"), or nullopt.
[[nodiscard]] std::optional<Error> writePrivateFile(const std::filesystem::path& file,
                                                    std::string_view text);

}  // namespace hapticast
