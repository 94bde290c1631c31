// SPDX-License-Identifier: MIT
// Cameras applied to an exact picture: the depth of four kinds of sensors with their ways of
// being wrong, and colour with noise and compression. Every frame from its own seed. Thread: one.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"
#include "tests/scenes/held/paint.hpp"

namespace hapticast::evaluate::held {

enum class DepthSense : std::uint8_t {
  kExact,       ///< mm
  kStructured,  ///< mm: shadow beside what is near, noise and steps ~ z², blind on fur, glare,
                ///< black
  kFlight,      ///< mm: rims mixed of near and far, more noise on dark, a fixed pattern
  kRoom8,       ///< 0..255 over the whole room, in a compressed video
  kEstimate8,   ///< 0..255 of inverse depth by an estimator: soft rims, its scale and shift flicker
  kEstimate16,  ///< the same as mm
};

struct Sensing {
  DepthSense kind = DepthSense::kExact;
  double beside_px = 0.0, below_px = 0.0;  ///< depth is drawn this far beside colour
  double flicker = 0.0;                    ///< rms of an estimator's scale and shift, share
  double exposure_swing = 0.0;             ///< share by which the brightness changes in the clip
  double green_cast = 0.0;                 ///< share of green too much until the camera balances
  double color_noise = 1.5;                ///< rms, levels
  int jpeg_quality = 88;                   ///< 0: not compressed
  double near_mm = 300.0;                  ///< what 255 and 0 are where depth is in 8 bits
  double far_mm = 3000.0;
  std::uint64_t seed = 1;

  [[nodiscard]] bool inHeights() const {
    return kind == DepthSense::kRoom8 || kind == DepthSense::kEstimate8;
  }
};

/// The exact picture: depth (CV_32FC1, mm), blind (CV_8UC1, Blindness), color (CV_8UC3).
struct Exact {
  cv::Mat color, depth, blind;
};

/// The brightness of colour at a moment of the clip (share 0..1 of its length).
double exposureAt(const Sensing& sensing, double share_of_clip);

/// The gain of each colour at a moment: the brightness, and a green cast in the first half.
Color gainAt(const Sensing& sensing, double share_of_clip);

/// The frame's colour and depth; `focal_px` of the camera.
void sense(const Sensing& sensing, const Exact& exact, double focal_px, server::RgbdFrame& frame);

}  // namespace hapticast::evaluate::held
