// SPDX-License-Identifier: MIT
// hapticast-evaluate log: a recording (proto/recording.md) as curves over time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluate/curves.hpp"

namespace hapticast::evaluate {

/// The curves of a recording, and a line about it.
struct RecordingCurves {
  std::vector<CurvePanel> panels;
  std::string line;
};

/// Reads the recording `file`. Throws std::runtime_error if it is none.
[[nodiscard]] RecordingCurves readCurves(const std::string& file);

/// Draws `file` into `out`/log.png: force, penetration, delay and losses of a client's recording;
/// sizes, objects and gaps of a server's. Prints one line. Throws std::runtime_error if `file` is
/// no recording.
void plotRecording(const std::string& file, const std::filesystem::path& out);

}  // namespace hapticast::evaluate
