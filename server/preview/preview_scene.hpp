// SPDX-License-Identifier: MIT
// The scene that a preview writes: the author's work so far, ready for further editing. Thread:
// any.
#pragma once

#include "server/preview/preview_frame.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Returns settings.scene with a named object for each start point of the author. If the author
/// marked no object, there is one for each object that vision found in `first`, the clip's first
/// frame, with its innermost pixel as its point (px of the clip's own pictures). A source with
/// masks of its own gets no object. The files of key masks are relative to the folder
/// settings.preview. `info`: that of the source.
[[nodiscard]] Scene completeScene(const Settings& settings, const PreviewFrame& first,
                                  const SourceInfo& info);

}  // namespace hapticast::server
