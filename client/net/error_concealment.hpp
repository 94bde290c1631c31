// SPDX-License-Identifier: MIT
// What a lost slice would have brought: the relief before, carried along with the object. Pure.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// A relief, and where its object was when it was seen so.
struct PosedRelief {
  std::shared_ptr<const Relief> relief;
  Motion motion;
};

/// Where the relief is once it is moved and turned as the object was until `now`: no more than the
/// picture, empty outside it.
[[nodiscard]] PixelRect warpedRect(const PosedRelief& before, const Motion& now,
                                   const Workspace& workspace);

/// Fills the pixels of `to` that `have` does not mark (a byte for each pixel of its rectangle) with
/// what `before` has there once it is moved, turned about its reference point and raised as the
/// object was until `now`.
void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to);

}  // namespace hapticast::client
