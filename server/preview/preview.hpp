// SPDX-License-Identifier: MIT
// Preview mode (--preview): runs vision over the clip without a network. It writes pictures of the
// segmented objects and prints facts about them. Thread: the pipeline's.
#pragma once

#include "common/time.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Writes the preview to settings.preview: one picture if that is FILE.png, or first.png, clip.png
/// and scene.json if it is a folder. For a live source it processes only the first seconds. Throws
/// SourceError with a message of one line if the source fails or the output path is not usable.
void writePreview(Settings settings, const Clock& clock);

}  // namespace hapticast::server
