// SPDX-License-Identifier: MIT
// Playing a clip on and on. Thread: the source's.
#pragma once

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Passes over `skip` frames and reads the next; at the clip's end it rewinds (a new epoch) if
/// `loop`. The first frame of a round is never passed over: objects are looked for in it, at the
/// points given for it. nullopt: the clip has ended. Throws SourceError as the source does.
std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop);

}  // namespace hapticast::server
