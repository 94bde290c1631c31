// SPDX-License-Identifier: MIT
// An edge: a server without vision. It receives the stream of a channel's origin from NATS and
// serves it to viewers of its own. Thread: the caller's.
#pragma once

#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/reload.hpp"

namespace hapticast::server {

/// Runs the edge of the channel `settings.source` until a signal ends it. It waits for an origin
/// before it accepts viewers. `reread`: reads the settings again at SIGHUP. Throws SourceError,
/// AddressError or std::runtime_error, each with a message of one line.
void runEdge(const Settings& settings, const Clock& clock, ReadSettings reread);

}  // namespace hapticast::server
