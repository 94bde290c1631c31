// SPDX-License-Identifier: MIT
// --preview: runs vision over the clip without a network, writes what the server took as pictures
// and prints it. Thread: the pipeline's.
#pragma once

#include "common/time.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Writes settings.preview: a picture (FILE.png), or first.png and clip.png in a folder. A live
/// source is watched for its first seconds. Throws SourceError, one line, where the source or the
/// place to write to is at fault.
void writePreview(const Settings& settings, const Clock& clock);

}  // namespace hapticast::server
