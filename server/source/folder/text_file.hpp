// SPDX-License-Identifier: MIT
// Reads small text files of a clip's folder. Thread: any.
#pragma once

#include <filesystem>
#include <string>

namespace hapticast::server {

/// Returns the text of `file`. Throws SourceError if it cannot be read or is larger than 16 MiB.
[[nodiscard]] std::string readText(const std::filesystem::path& file);

}  // namespace hapticast::server
