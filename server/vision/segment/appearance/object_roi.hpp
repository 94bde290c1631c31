// SPDX-License-Identifier: MIT
// Region of interest (ROI) of one object for the narrow-band step. It has full size for a small
// object, and a half or a third of the size for a large one. That bounds the cost. The band has a
// constant width in px, so it covers more of the scene if the size is reduced. Thread: the one that
// runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/appearance/planes.hpp"
#include "server/vision/segment/appearance/skin.hpp"

namespace hapticast::server {

/// Images of a frame, and the model of its scene: planes, depth noise and skin colours. Thread: the
/// one that runs Vision.
struct FrameContext {
  const FrameImages& images;
  const std::vector<Plane>& planes;
  const DepthNoise& noise;
  const SkinColors& skin;
  /// CV_8UC1, size of the image, 255: pixels with the colours of the hand that holds the object.
  /// Empty: unknown.
  cv::Mat hand{};

  /// Returns 255 where the part `box` of the image (px) may show a hand, CV_8UC1 of `size`. If
  /// `hand` is known, that is skin or dark skin inside `hand`; otherwise it is skin.
  [[nodiscard]] cv::Mat findHands(const cv::Rect& box, const cv::Size& size) const;
  /// Returns 255 where `box` may show skin or dark skin, CV_8UC1 of `size`.
  [[nodiscard]] cv::Mat findDarkSkin(const cv::Rect& box, const cv::Size& size) const;
};

/// Region of the picture for a graph cut. All images have the size of size().
struct GraphRoi {
  cv::Rect box;         ///< part of the picture that the region covers, px
  double shrink = 1.0;  ///< px of the ROI for each px of the picture, at most 1
  cv::Mat color;        ///< CV_8UC3, BGR
  cv::Mat lab;          ///< CV_32FC3, L 0..100
  cv::Mat depth;        ///< CV_32FC1, working depth, mm, 0: not measured
  cv::Mat plane;        ///< CV_8UC1, 255 on a plane or behind a supporting plane
  cv::Mat skin;         ///< CV_8UC1, 255: FrameContext::findHands()
  /// CV_32FC1, 0..1: depth of valleys in the surface. Two bodies that touch meet in a valley.
  /// Empty after makeAround().
  cv::Mat valley;

  /// Returns the region `box` (px of the picture), reduced so that it has at most `most_px` pixels.
  static GraphRoi makeAround(const FrameContext& scene, const cv::Rect& box, double most_px);
  /// Returns the same region as makeAround(), but also computes `valley`.
  static GraphRoi makeWithValleys(const FrameContext& scene, const cv::Rect& box, double most_px);
  [[nodiscard]] cv::Size size() const { return lab.size(); }
  /// shrinkImage() converts a mask of the whole picture to this region. placeInPicture() converts a
  /// mask of this region to the whole picture. Masks are 0/255.
  [[nodiscard]] cv::Mat shrinkImage(const cv::Mat& mask) const;
  [[nodiscard]] cv::Mat placeInPicture(const cv::Mat& mask, const cv::Size& picture) const;
  /// Returns the largest difference of depth that neighbouring pixels of this region can have on
  /// one surface, mm.
  [[nodiscard]] float step_mm(const DepthNoise& scene, float depth_mm) const {
    return static_cast<float>((0.5 + 0.5 / shrink) * scene.step_mm(double(depth_mm)));
  }
  /// Returns the pixel of this region for a position `at` in the picture, px.
  [[nodiscard]] cv::Point toRoi(const cv::Point& at) const;
};

/// Half of the band's width, px of the patch. Each frame decides anew the pixels at most this far
/// from the contour.
inline constexpr int kBand_px = 7;
/// Width of the ring of background around the band, px of the patch.
inline constexpr int kRing_px = 20;

/// Patch: the images of a region around an object, with its expected mask. Empty if there is no
/// object.
struct ObjectRoi {
  cv::Rect box;      ///< part of the picture, px; multiples of `factor`
  int factor = 1;    ///< px of the picture for each px of the patch, each way
  cv::Mat color;     ///< CV_8UC3
  cv::Mat depth;     ///< CV_32FC1, working depth, mm
  cv::Mat gray;      ///< CV_8UC1, at full size, for the guided filter of the contour
  cv::Mat inside;    ///< CV_8UC1, 0/255: the object is expected and not hidden
  cv::Mat hidden;    ///< CV_8UC1, 0/255: the object is expected, but a nearer surface hides it
  cv::Mat nearer;    ///< CV_8UC1, 0/255: nearer than the object can be, or a hand. Empty: unknown
  cv::Mat farther;   ///< CV_8UC1, 0/255: farther than the object can be. Empty: unknown
  cv::Mat distance;  ///< CV_32FC1, px of the patch: distance to the contour, inside > 0

  [[nodiscard]] bool empty() const { return box.empty(); }
  /// Return the position in the picture of column u or row v of the patch (pixel centres lie at
  /// whole numbers).
  [[nodiscard]] double pictureU(int u) const { return box.x + factor * (u + 0.5) - 0.5; }
  [[nodiscard]] double pictureV(int v) const { return box.y + factor * (v + 0.5) - 0.5; }
  /// Returns the matrix that maps pixels of the patch to the picture, as pictureU() and pictureV()
  /// do.
  [[nodiscard]] cv::Matx33d toPicture() const;
};

/// Limits of the object's pixels. Pixels nearer than `nearest_mm` and hands hide the object. Pixels
/// farther than `farthest_mm` are background.
struct ObjectLimits {
  double nearest_mm = 0.0;           ///< 0: unknown
  double farthest_mm = 0.0;          ///< 0: unknown
  const SkinColors* hand = nullptr;  ///< skin colours; null: unknown
  /// Evidence of each colour bin for the object (colorEvidence()). A skin colour with evidence
  /// above 0 does not count as a hand. Empty: unknown.
  std::vector<float> colors{};
};
/// Returns a mask of `color` (CV_8UC3): 255 where the colour is that of a hand according to
/// `limits`, 0 elsewhere.
cv::Mat findHand(const cv::Mat& color, const ObjectLimits& limits);
/// Returns the patch around the object, whose mask in the last picture was `mask` (0/255).
/// `similarity` maps px of the last picture to px of this picture.
ObjectRoi makePatch(const FrameImages& images, const cv::Mat& mask, const cv::Matx23d& similarity,
                    const ObjectLimits& limits);
/// Returns the patch around the object, whose mask in this picture is `mask` (0/255). No limits of
/// depth or skin apply.
ObjectRoi makePatch(const FrameImages& images, const cv::Mat& mask);

/// Moves `image` from the last picture into the patch `to` of this picture by `similarity` (px of
/// the last picture to px of this one). Pixels without a source are 0. `from` maps pixels of
/// `image` to px of the last picture.
cv::Mat warpPatch(const cv::Mat& image, const cv::Matx33d& from, const ObjectRoi& to,
                  const cv::Matx23d& similarity);

/// scaleToFullSize() converts a mask from the patch's size to the full size of the patch's box.
/// scaleToPatchSize() converts such a mask back to the patch's size.
cv::Mat scaleToFullSize(const cv::Mat& mask, const ObjectRoi& patch);
cv::Mat scaleToPatchSize(const cv::Mat& mask, const ObjectRoi& patch);

/// Returns a mask of the whole picture from `mask`, which covers the patch's box at full size.
cv::Mat wholePicture(const cv::Mat& mask, const ObjectRoi& patch, const FrameImages& images);

/// Returns a mask of the patch's size: 255 in the band where the depth is on a plane or behind a
/// supporting plane.
cv::Mat findBandOnPlanes(const ObjectRoi& patch, const std::vector<Plane>& planes);

/// Depths of an object in one frame: its 10 %, 50 % and 90 % quantiles, mm.
struct DepthSpan {
  double near_mm = 0.0, middle_mm = 0.0, far_mm = 0.0;

  /// Return the nearest and the farthest depth that a pixel of the object can have, mm; 0: unknown.
  [[nodiscard]] double nearest_mm(const DepthNoise& noise) const;
  [[nodiscard]] double farthest_mm(const DepthNoise& noise) const;
};
/// Returns the quantiles of the depths where `inside` (0/255) is set. It reads every second pixel
/// and row. Returns nullopt if fewer than ten of these pixels were measured.
std::optional<DepthSpan> depthSpan(const ObjectRoi& patch, const cv::Mat& inside);

}  // namespace hapticast::server
