// SPDX-License-Identifier: MIT
// Loop playback of a clip. Thread: the source's.
#pragma once

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Skips `skip` frames and reads the next. At the clip's end it rewinds (a new epoch) if `loop`.
/// The first frame of a round is never skipped, because objects start in it at the author's points.
/// Returns nullopt at the end of the clip. Throws SourceError.
std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop);

}  // namespace hapticast::server
