// SPDX-License-Identifier: MIT
// Plot of the force over time.
// Thread: any (pure functions).
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "client/view/force_history.hpp"

namespace hapticast::client {

// Colours of the overlay, BGR.
inline const cv::Scalar kGroundColor(28, 26, 24);
inline const cv::Scalar kTextColor(215, 212, 208);
inline const cv::Scalar kMomentColor(250, 250, 250);
// Colours of the forces, as in the window.
inline const cv::Scalar kForceColor(64, 214, 255);
inline const cv::Scalar kStaticForceColor(255, 120, 64);
inline const cv::Scalar kDynamicForceColor(48, 56, 255);

/// Draws a line of small text with the lower left corner `at` (px).
void putLabel(cv::Mat& image, const std::string& text, cv::Point at, const cv::Scalar& color);

/// Returns a plot of all points of `history`: CV_8UC3 of `size` px (at least 100 x 100). It has
/// total, static and dynamic force, a shade during contact, and a mark at `marked_s` (since the
/// first tick, like all times of the plot).
[[nodiscard]] cv::Mat drawForcePlot(const ForceHistory& history, double marked_s, cv::Size size);

}  // namespace hapticast::client
