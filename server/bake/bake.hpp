// SPDX-License-Identifier: MIT
// `hapticast-server bake`: computes a clip with OfflineVision and writes a recording (BakedFile).
// It has no port and no pace, and drops no frame. Thread: main.
#pragma once

#include "common/time.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Bakes the clip. Returns the exit code: kDone, or kFailed after Ctrl-C, with one line. Throws
/// SourceError or RecordingError for wrong input, and std::runtime_error for a failure at run time;
/// each message has one line. `started` becomes true when the input is valid and the work begins.
int bake(const Settings& settings, const Clock& clock, bool& started);

}  // namespace hapticast::server
