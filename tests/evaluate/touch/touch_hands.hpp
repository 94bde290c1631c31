// SPDX-License-Identifier: MIT
// Scripted hands that touch relief scenes, with the exact displacement that each should meet.
// Nominal mm.
#pragma once

#include "tests/evaluate/touch/touch_player.hpp"
#include "tests/scenes/relief_scenes.hpp"

namespace hapticast::evaluate {

/// Lissajous over the body, up to `reach_mm` from its reference point, 0..1.5 mm deep along the
/// normal, with lift-offs. Exact while depth is below the radius of curvature.
Hand slidingHand(const TouchScene& scene, double reach_mm);
/// Comes from above to a place of the body (turned with it), then stays there, this deep.
Hand holdingHand(const TouchScene& scene, const Vec2& in_body_mm, double depth_mm);
/// Comes from above, then stands still; the expected displacement is the height over it: for
/// surfaces that are level there.
Hand stillHand(const TouchScene& scene, const Vec3& hip_mm);

/// From the side into the wall, `push_mm` deep, along it to and fro and away again.
Hand pushingHand(const Wall& wall, double push_mm);
PlayTimes pushTimes(const Wall& wall);
/// From above, `inside_mm` from the wall's edge, 1 mm deep (until leaveStart_s), then out over it.
Hand rimHand(const Wall& wall, double inside_mm);
PlayTimes rimPressTimes();
PlayTimes rimLeaveTimes();

}  // namespace hapticast::evaluate
