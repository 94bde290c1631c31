// SPDX-License-Identifier: MIT
// hapticast-evaluate log: a recording (proto/recording.md) as curves over time.
#pragma once

#include <filesystem>
#include <string>

namespace hapticast::evaluate {

/// Draws `file` into `out`/log.png: force, penetration, delay and losses of a client's recording;
/// sizes, objects and gaps of a server's. Prints one line. Throws std::runtime_error if `file` is
/// no recording.
void plotRecording(const std::string& file, const std::filesystem::path& out);

}  // namespace hapticast::evaluate
