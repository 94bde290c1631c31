// SPDX-License-Identifier: MIT
// A ball as a noisy sensor sees it, for the tests of what is at rest.
#pragma once

#include "server/vision/base/masks.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server::test {

inline constexpr double kSigma_mm = 1.5;  ///< of the depth

/// Depth noise correlated over 2 px, colour noise, an outline that
/// flickers by a pixel. Every frame has noise of its own, the same in every run.
struct NoisyBall {
  BallScene scene{.radius_px = 60};
  double color_sigma = 2.0;
  double brightness = 1.0;

  [[nodiscard]] RgbdFrame frame(std::uint64_t index, double u, double v, double closer_mm) const {
    RgbdFrame out = scene.frame(index, u, v, closer_mm);
    cv::RNG random(1000 + index);
    cv::Mat noise(out.depth.size(), CV_32FC1);
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(noise, noise, {}, 1.0);
    out.depth += noise * (kSigma_mm * 2 * std::sqrt(CV_PI));  // sigma of white noise blurred by 1
    cv::Mat color_noise(out.color.size(), CV_32FC3);
    random.fill(color_noise, cv::RNG::NORMAL, 0, color_sigma);
    cv::Mat color;
    out.color.convertTo(color, CV_32FC3, brightness);
    color += color_noise;
    color.convertTo(out.color, CV_8UC3);
    const cv::Mat rim = dilateBy(out.mask * 255, 1) & ~erodeBy(out.mask * 255, 1);
    cv::Mat flips(out.mask.size(), CV_8UC1);
    random.fill(flips, cv::RNG::UNIFORM, 0, 2);
    flips.copyTo(out.mask, rim);
    cv::morphologyEx(out.mask, out.mask, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8UC1));
    return out;
  }
};

}  // namespace hapticast::server::test
