// SPDX-License-Identifier: MIT
// Subcommand touch: the haptic loop beside the stream of a server. The loop, the network and the
// decoding of frames have a thread each. Thread: main.
#pragma once

#include "client/settings/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// Touches the stream of the server of `settings`; `views` receive the pictures and the reports. If
/// no server answers, the client retries. The run ends when --seconds are over, when a signal
/// arrives (stopAtSignals()), when the user ends it in a view, or when the server cannot be used.
///
/// Returns the exit code: kFailed, after a line in the log, if the server cannot be used, if none
/// was connected within --seconds, or if a file is not complete. Throws std::runtime_error (one
/// line) if the run cannot begin: the device cannot be opened, or a setting is invalid.
int runTouch(const Settings& settings, const Clock& clock, Views views);

}  // namespace hapticast::client
