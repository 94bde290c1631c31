// SPDX-License-Identifier: MIT
// A server that plays a recording on demand (--source FILE.mcap --on-demand): each viewer has a
// time line of its own. Thread: the caller's.
#pragma once

#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/reload.hpp"

namespace hapticast::server {

/// Serves the recording `settings.source` until a signal. With --loop each time line repeats.
/// Throws as playRecording() does.
void playOnDemand(const Settings& settings, const Clock& clock, ReadSettings reread);

}  // namespace hapticast::server
