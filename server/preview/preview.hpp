// SPDX-License-Identifier: MIT
// Preview mode (--preview): runs vision over the clip without a network, writes the segmented
// objects as pictures and prints facts. Thread: the pipeline's.
#pragma once

#include "common/time.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Writes settings.preview: a picture (FILE.png), or first.png and clip.png in a folder. Processes
/// the first seconds only of a live source. Throws SourceError, one line, if the source or the
/// output place is at fault.
void writePreview(const Settings& settings, const Clock& clock);

}  // namespace hapticast::server
