// SPDX-License-Identifier: MIT
// The look of surfaces, and the share that a depth camera measures. Thread: any; values.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry.hpp"

namespace hapticast::evaluate::held {

using Color = Eigen::Vector3f;  ///< blue, green, red; linear light, 0..1

enum class Pattern : std::uint8_t {
  kPlain,     ///< a little uneven
  kBlotches,  ///< two colours, as a marbled or worn thing has
  kStripes,   ///< along y, `scale_mm` apart
  kChecks,    ///< a plaid across x and y
  kFur,       ///< tufts
  kSkin,
  kFingertip,  ///< skin with a nail at -z
  kWood,       ///< grain along x
  kDots,
  kLabel,    ///< a band of the second colour with writing, about y = 0
  kRim,      ///< the second colour above y = `scale_mm` and inside a mug
  kPatches,  ///< cloth of three colours: both and white
  kShelf,    ///< rows of coloured backs of books in x and y
};

struct Paint {
  Pattern pattern = Pattern::kPlain;
  Color color{0.5F, 0.5F, 0.5F};
  Color second{0.2F, 0.2F, 0.2F};
  double scale_mm = 20.0;
  float gloss = 0.0F;  ///< strength of the light's reflection
  float holes = 0.0F;  ///< share of the surface that a depth camera does not see
};

/// Smooth noise in space, 0..1 about 0.5, finest detail 6 mm.
double solidNoise(const Vec3& at_mm);

/// The colour of a place of the surface, in the frame of its part.
Color colorAt(const Paint& paint, const Vec3& at_mm);
/// Whether a depth camera that does not like such surfaces sees nothing there.
bool holeAt(const Paint& paint, const Vec3& at_mm);

}  // namespace hapticast::evaluate::held
