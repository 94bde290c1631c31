// SPDX-License-Identifier: MIT
// A server that plays a recording (--source FILE.mcap) to its viewers, without vision. Operators
// can pause it, seek, and change its speed and material. Thread: the caller's.
#pragma once

#include <string>

#include "common/playback/stream_reader.hpp"
#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/reload.hpp"

namespace hapticast::server {

/// Opens the recording of a stream `file`. Throws RecordingError with one line that names --source.
[[nodiscard]] StreamReader openRecording(const std::string& file);

/// Plays the recording `settings.source` until it ends (with --loop it repeats), until the number
/// of frames in --frames is reached, or until a signal. `reread`: reads the settings again at
/// SIGHUP. Throws RecordingError, AddressError, KeyFileError or std::runtime_error, each with one
/// line.
void playRecording(const Settings& settings, const Clock& clock, ReadSettings reread);

}  // namespace hapticast::server
