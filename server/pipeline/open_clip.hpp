// SPDX-License-Identifier: MIT
// Opens the source of the settings with all that adds to its frames: the depth and the masks of the
// user's programs, and the key masks of the scene file. Thread: any.
#pragma once

#include <memory>

#include "server/settings/settings.hpp"
#include "server/source/child/child_settings.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Returns the source. Starts the user's programs and waits for their first answers. The source
/// calls `keep_waiting` while it waits for them; it may be null. Throws SourceError.
[[nodiscard]] std::unique_ptr<RgbdSource> openClip(const Settings& settings,
                                                   const KeepWaiting& keep_waiting = nullptr);

/// Returns the properties of `source` with the stream's name of `settings`, if they have one.
[[nodiscard]] SourceInfo describeSource(const RgbdSource& source, const Settings& settings);

}  // namespace hapticast::server
