// SPDX-License-Identifier: MIT
// The scene that a preview writes: the author's work so far, ready for further editing. Thread:
// any.
#pragma once

#include "server/preview/preview_frame.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Returns settings.scene, completed with named objects. If the scene names no object, each point
/// of the author in the first frame becomes a named object. If the author marked no object at all,
/// each object that vision found in `first`, the clip's first frame, becomes one. Its point is the
/// pixel farthest from the edge of its mask (px of the clip's own pictures). If the source has key
/// masks, no objects are added. The files of key masks become relative to the folder
/// settings.preview. `info`: properties of the source.
[[nodiscard]] Scene completeScene(const Settings& settings, const PreviewFrame& first,
                                  const SourceInfo& info);

}  // namespace hapticast::server
