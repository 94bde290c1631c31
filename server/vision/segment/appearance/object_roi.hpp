// SPDX-License-Identifier: MIT
// Region of interest (ROI) of one object for the narrow-band step: full size for a small object, a
// half or a third of it for a large one.
// The band's width in px is constant, so it covers more of the scene there, and the cost is
// bounded. Thread: the one that runs Vision.
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

// Region of interest (ROI) for graph cuts: a part of the picture, reduced so that each of its
// pixels can be a node of a graph. Thread: the one that runs Vision.

/// A frame, and the model of the scene behind its objects.
struct FrameContext {
  const FrameImages& images;
  const std::vector<Plane>& planes;
  const DepthNoise& noise;
  const SkinColors& skin;
};

/// Images of the region, all of size().
struct GraphRoi {
  cv::Rect box;         ///< of the picture
  double shrink = 1.0;  ///< px of the ROI for each px of the picture, at most 1
  cv::Mat color;        ///< CV_8UC3, BGR
  cv::Mat lab;          ///< CV_32FC3, L 0..100
  cv::Mat depth;        ///< CV_32FC1, working depth, mm, 0: not measured
  cv::Mat plane;        ///< CV_8UC1, 255 on a plane or behind a support
  cv::Mat skin;         ///< CV_8UC1, 255: skin

  /// Returns the ROI of `box` (px of the picture) with at most `most_px` pixels.
  static GraphRoi around(const FrameContext& scene, const cv::Rect& box, double most_px);
  [[nodiscard]] cv::Size size() const { return lab.size(); }
  /// Converts a mask (0/255) of the whole picture to this ROI, and a mask of this ROI to the whole
  /// picture.
  [[nodiscard]] cv::Mat shrunk(const cv::Mat& mask) const;
  [[nodiscard]] cv::Mat inPicture(const cv::Mat& mask, const cv::Size& picture) const;
  /// Returns the largest depth step between neighbours of the ROI on one surface, mm.
  [[nodiscard]] float step_mm(const DepthNoise& scene, float depth_mm) const {
    return static_cast<float>((0.5 + 0.5 / shrink) * scene.step_mm(double(depth_mm)));
  }
  /// Converts a position in the picture to the ROI, px.
  [[nodiscard]] cv::Point toRoi(const cv::Point& at) const;
};

/// Returns the px of the picture for one mm at `depth_mm`, for a camera with a usual field of view.
double pixelsPerMm(double depth_mm, const cv::Size& picture);

inline constexpr int kBand_px = 7;   ///< px of the patch: pixels decided anew, inwards and outwards
inline constexpr int kRing_px = 20;  ///< px of the patch: background beyond the band

/// The patch: images around an object. Empty if there is no object.
struct ObjectRoi {
  cv::Rect box;      ///< of the picture; multiples of `factor`
  int factor = 1;    ///< px of the picture for each px of the patch, each way
  cv::Mat color;     ///< CV_8UC3
  cv::Mat depth;     ///< CV_32FC1, working depth, mm
  cv::Mat gray;      ///< CV_8UC1, at full size: guide for the contour
  cv::Mat inside;    ///< CV_8UC1, 0/255: the object is expected and not hidden
  cv::Mat hidden;    ///< CV_8UC1, 0/255: the object is expected, but a nearer surface hides it
  cv::Mat nearer;    ///< CV_8UC1, 0/255: nearer than the object can be, or a hand. Empty: unknown
  cv::Mat farther;   ///< CV_8UC1, 0/255: farther than the object can be. Empty: unknown
  cv::Mat distance;  ///< CV_32FC1, px of the patch: distance to the contour, inside > 0

  [[nodiscard]] bool empty() const { return box.empty(); }
  /// Returns the position in the picture of a pixel of the patch (pixel centres at whole numbers).
  [[nodiscard]] double pictureU(int u) const { return box.x + factor * (u + 0.5) - 0.5; }
  [[nodiscard]] double pictureV(int v) const { return box.y + factor * (v + 0.5) - 0.5; }
  /// Returns pictureU() and pictureV() as a matrix.
  [[nodiscard]] cv::Matx33d toPicture() const;
};

/// Limits of the object: nearer pixels and hands hide it, farther pixels are background.
struct ObjectLimits {
  double nearest_mm = 0.0;           ///< 0: unknown
  double farthest_mm = 0.0;          ///< 0: unknown
  const SkinColors* hand = nullptr;  ///< null: the object's own colours resemble skin
  /// Colours of the object itself, even if they resemble skin; null: unknown.
  const ColorHistogram* own = nullptr;
};
/// Returns the patch around `mask` (of the last picture, 0/255) moved by `similarity` (last px ->
/// this px).
ObjectRoi patchAround(const FrameImages& images, const cv::Mat& mask, const cv::Matx23d& similarity,
                      const ObjectLimits& limits);
/// Returns the patch around `mask` (0/255) of this picture, without limits.
ObjectRoi patchAround(const FrameImages& images, const cv::Mat& mask);

/// Warps `image`, which covers `from` of the last picture, into patch `to` of this picture. Pixels
/// without a source are 0.
cv::Mat warpPatch(const cv::Mat& image, const cv::Matx33d& from, const ObjectRoi& to,
                  const cv::Matx23d& similarity);

/// Converts a mask between the patch's size and the full size of the patch's box.
cv::Mat atFullSize(const cv::Mat& mask, const ObjectRoi& patch);
cv::Mat atPatchSize(const cv::Mat& mask, const ObjectRoi& patch);

/// Returns a mask of image size from a mask over the patch's box at full size.
cv::Mat wholePicture(const cv::Mat& mask, const ObjectRoi& patch, const FrameImages& images);

/// Returns 255 in the band where the depth is on a plane or behind a support; size of the patch.
cv::Mat bandOnPlanes(const ObjectRoi& patch, const std::vector<Plane>& planes);

/// Depths of an object in one frame: its 10 %, 50 % and 90 % quantiles, mm.
struct DepthSpan {
  double near_mm = 0.0, middle_mm = 0.0, far_mm = 0.0;

  /// Return the depths, mm, beyond which a pixel cannot be the object's; 0: unknown.
  [[nodiscard]] double nearest_mm(const DepthNoise& noise) const;
  [[nodiscard]] double farthest_mm(const DepthNoise& noise) const;
};
/// Returns the depths of the pixels of `inside` (0/255); nullopt if fewer than ten are measured.
std::optional<DepthSpan> depthSpan(const ObjectRoi& patch, const cv::Mat& inside);

}  // namespace hapticast::server
