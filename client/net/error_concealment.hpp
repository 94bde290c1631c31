// SPDX-License-Identifier: MIT
// Error concealment: replaces lost slices of a relief by the previous relief, moved with the
// object.
// Thread: any (pure functions).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// A relief and the motion of its object at that time.
struct PosedRelief {
  std::shared_ptr<const Relief> relief;
  Motion motion;
};

/// Returns the rectangle of the relief after the object's motion to `now`, clipped to the picture;
/// empty outside it.
[[nodiscard]] PixelRect warpedRect(const PosedRelief& before, const Motion& now,
                                   const Workspace& workspace);

/// Fills the pixels of `to` that `have` does not mark. `have` has one byte for each pixel of
/// to.rect. The values are those of `before`, moved to the pose `now`: translated, turned about the
/// reference point, and raised.
void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to);

}  // namespace hapticast::client
