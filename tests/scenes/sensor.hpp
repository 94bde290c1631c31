// SPDX-License-Identifier: MIT
// What cameras make of an exact picture: noise, compression, depth beside colour, and the sensor of
// scenes of bodies. Their noise is that of common depth cameras (tests/evaluate/README.md).
// Thread: any; values.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"

namespace hapticast::evaluate {

/// Returns normal noise of rms 1, correlated over `sigma_px` (0: white).
cv::Mat makeNoise(cv::RNG& random, const cv::Size& size, double sigma_px);
/// Adds white noise of this rms (grey levels) to a picture of three channels.
void addColorNoise(cv::Mat& color, double rms, cv::RNG& random);
/// Returns the picture after JPEG of this quality (1..100), in the same number of channels.
cv::Mat compressJpeg(const cv::Mat& picture, int quality);
/// Returns the depth as it lies this far to the right of and below colour.
cv::Mat shiftDepth(const cv::Mat& depth, double right_px, double down_px);

/// The sensor of a scene of bodies, applied to the exact picture.
struct Sensor {
  enum class Depth : std::uint8_t {
    kExact,         ///< mm as float
    kStereo,        ///< 1.5 mm x z² (m), correlated over 2 px and in time; wobbling rim; holes
    kTimeOfFlight,  ///< 1.6 mm white + 0.8 mm fixed; flying and missing rim pixels
    kEightBit,      ///< 255 levels over the depth range, as DepthKind::kHeight
  };
  Depth depth = Depth::kExact;
  int levels_per_step = 1;      ///< kEightBit: only every so many levels are used
  double depth_noise_mm = 0.0;  ///< white, added to kExact and before kEightBit is rounded
  double color_noise = 1.0;     ///< rms, grey levels
  int misalignment_px = 0;      ///< depth is shifted right by this against colour
  double mask_wobble_px = 0.0;  ///< rms of the given mask's edge, anew in every frame
  bool jpeg = false;            ///< colour went through JPEG, quality 80
};

/// What stays the same from frame to frame in the depth of one sensor.
struct SensorState {
  cv::Mat fixed_noise;    ///< of the sensor, rms 1
  cv::Mat carried_noise;  ///< empty before the first frame
};

/// Returns the sensor's depth of an exact one (CV_32FC1, mm); `mask` (0 / 255): the object, at
/// whose edge stereo is blind; `range`: what 255 and 0 are in 8 bits.
cv::Mat senseDepth(const Sensor& sensor, const cv::Mat& exact_mm, const cv::Mat& mask,
                   const server::DepthRange& range, SensorState& state, cv::RNG& random);
/// Returns the mask with its edge moved in and out by a smooth field of this rms.
cv::Mat wobbleMask(const cv::Mat& mask, double rms_px, cv::RNG& random);

}  // namespace hapticast::evaluate
