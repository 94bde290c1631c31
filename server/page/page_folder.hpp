// SPDX-License-Identifier: MIT
// The page as a folder that any web server can serve. The page plays the recording in the folder,
// without a server of hapticast. Thread: main.
#pragma once

#include <string>

namespace hapticast::server {

/// Name of the recording in the folder of a page.
inline constexpr const char* kPageRecording = "recording.mcap";

/// Creates `folder` for a page. Throws std::runtime_error with one line if this build has no page,
/// or the folder cannot be created.
void createPageFolder(const std::string& folder);
/// Writes the files of the page into `folder`. Throws std::runtime_error with one line that names
/// the file.
void writePageFolder(const std::string& folder);

}  // namespace hapticast::server
