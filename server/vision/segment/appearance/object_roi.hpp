// SPDX-License-Identifier: MIT
// The surroundings of one object as the band step sees them: at full size where the object is
// small, at a half or a third where it is large. A band of so many pixels is wider there in the
// scene, and the work stays the same.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/appearance/planes.hpp"
#include "server/vision/segment/appearance/skin.hpp"

namespace hapticast::server {

inline constexpr int kBand_px = 7;   ///< of a patch: what is decided anew, inwards and outwards
inline constexpr int kRing_px = 20;  ///< of a patch: background beyond the band

struct ObjectRoi {
  cv::Rect box;      ///< of the picture; whole multiples of `factor`. Empty: there is no object
  int factor = 1;    ///< px of the picture per px of the patch, each way
  cv::Mat color;     ///< CV_8UC3
  cv::Mat depth;     ///< CV_32FC1, working depth
  cv::Mat gray;      ///< CV_8UC1, at full size: the contour is put on its edges
  cv::Mat inside;    ///< CV_8UC1, 0 / 255: where the object is expected and nothing hides it
  cv::Mat hidden;    ///< CV_8UC1, 0 / 255: where it is expected, but something nearer is seen
  cv::Mat nearer;    ///< CV_8UC1, 0 / 255: nearer than the object can be, or a hand. Empty: unknown
  cv::Mat farther;   ///< CV_8UC1, 0 / 255: farther than the object can be. Empty: unknown
  cv::Mat distance;  ///< CV_32FC1, px of the patch: how far inside the contour; outside below 0

  [[nodiscard]] bool empty() const { return box.empty(); }
  /// Position in the picture of a pixel of the patch (pixel centres at whole numbers).
  [[nodiscard]] double pictureU(int u) const { return box.x + factor * (u + 0.5) - 0.5; }
  [[nodiscard]] double pictureV(int v) const { return box.y + factor * (v + 0.5) - 0.5; }
  /// The same for all of it at once.
  [[nodiscard]] cv::Matx33d toPicture() const;
};

/// What cannot be the object: what is nearer, or a hand, hides it; what is farther is seen past it.
struct ObjectLimits {
  double nearest_mm = 0.0;           ///< 0: not known
  double farthest_mm = 0.0;          ///< 0: not known
  const SkinColors* hand = nullptr;  ///< null: the object's own colours are like those
  /// Colours that are the object's own, although they may be a hand's; null: none are known.
  const ColorHistogram* own = nullptr;
};
/// The patch around `mask` (of the last picture, 0 / 255) moved by `similarity` (last px -> this
/// px).
ObjectRoi patchAround(const FrameImages& images, const cv::Mat& mask, const cv::Matx23d& similarity,
                      const ObjectLimits& limits);
/// Of a mask in this picture.
ObjectRoi patchAround(const FrameImages& images, const cv::Mat& mask);

/// `image`, given over `from` of the last picture, carried into patch `to` of this one; 0 where it
/// was not.
cv::Mat warpPatch(const cv::Mat& image, const cv::Matx33d& from, const ObjectRoi& to,
                  const cv::Matx23d& similarity);

/// A mask over the patch's box at full size, and back.
cv::Mat atFullSize(const cv::Mat& mask, const ObjectRoi& patch);
cv::Mat atPatchSize(const cv::Mat& mask, const ObjectRoi& patch);

/// A mask over the patch's box at full size, in a picture of its own.
cv::Mat wholePicture(const cv::Mat& mask, const ObjectRoi& patch, const FrameImages& images);

/// 255 in the band where depth is on a plane or behind a support.
cv::Mat bandOnPlanes(const ObjectRoi& patch, const std::vector<Plane>& planes);

/// The depths of an object in one frame: between its 10 % and 90 % quantile.
struct DepthSpan {
  double near_mm = 0.0, middle_mm = 0.0, far_mm = 0.0;

  /// What is nearer, or farther, than this cannot be it; 0: not known.
  [[nodiscard]] double nearest_mm(const DepthNoise& noise) const;
  [[nodiscard]] double farthest_mm(const DepthNoise& noise) const;
};
/// Of the pixels `inside` (0 / 255); nullopt where too few are known.
std::optional<DepthSpan> depthSpan(const ObjectRoi& patch, const cv::Mat& inside);

}  // namespace hapticast::server
