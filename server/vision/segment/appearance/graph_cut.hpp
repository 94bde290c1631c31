// SPDX-License-Identifier: MIT
// Graph cut segmentation: models colours by Gaussian mixtures in Lab. The minimum cut of a graph of
// pixels then separates object and background (Boykov and Jolly 2001). The mixtures are those of
// GrabCut (Rother, Kolmogorov and Blake 2004). Thread: the one that runs Vision.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Distribution of colours in Lab, as a mixture of up to five Gaussians.
class ColorMixture {
 public:
  ColorMixture() = default;
  /// Fits the mixture to the pixels of `lab` (CV_32FC3) where `where` is not 0. The mixture is
  /// empty if there are fewer than eight such pixels.
  ColorMixture(const cv::Mat& lab, const cv::Mat& where);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Returns the logarithm of the density at the colour `lab`, but at least kLeast.
  [[nodiscard]] float logDensity(const cv::Vec3f& lab) const;

  static constexpr float kLeast = -30.0F;

 private:
  struct Part {
    cv::Vec3f mean;
    cv::Matx33f inverse;
    float log_weight = 0.0F;  // includes the determinant
  };
  std::vector<Part> parts_;
};

/// Returns the logarithms of the densities at all pixels of `lab` (CV_32FC3), as CV_32FC1.
cv::Mat logDensities(const ColorMixture& mixture, const cv::Mat& lab);

/// Weights of a cut. Evidence is in nats, above 0 for the object. A weight of 0 means that this
/// kind of cut does not use the evidence. Unless marked "chosen", the values were tuned on drawn
/// scenes of objects in hands.
struct CutWeights {
  double most_px = 0.0;      ///< largest number of pixels; chosen for time
  int rounds = 1;            ///< iterations of colour model and cut; chosen
  float color = 1.0F;        ///< factor of the evidence of colour
  float most_color = 0.0F;   ///< limit of the evidence of colour
  float far_color = 0.0F;    ///< factor of the negative points' colours, far from these points
  float plane = 0.0F;        ///< evidence of a pixel on or behind a supporting plane
  float skin = 0.0F;         ///< evidence of a pixel of skin, unless the object is skin
  float other_depth = 0.0F;  ///< evidence of a pixel outside the object's depths
  float own_depth = 0.0F;    ///< evidence of a pixel inside them
  /// Evidence of a pixel without depth: hole * (share - beside_object). `share` is the share of the
  /// object's depth component among the nearest measured pixels in the four directions.
  float hole = 0.0F;
  float beside_object = 0.0F;  ///< high, because a shadow has background on one side
  float per_px = 0.0F;         ///< evidence per px inside the old contour; negative outside it
  float farthest_px = 0.0F;    ///< limit of that distance
  float old_mask = 0.0F;       ///< evidence of the old mask, far from the author's points
  float point = 0.0F;          ///< evidence of the position, at a point
  float sure = 1e3F;           ///< evidence of a seed: more than all other terms of a pixel
  float together = 6.0F;       ///< cost of a cut between two neighbours of equal colour
  float across_step = 0.25F;   ///< factor of that cost across a step in depth
  float across_valley = 0.3F;  ///< factor of that cost in a deep valley, if known
};

// The weights for each kind of cut.

/// First mask at a click (initial_mask). This cut is OpenCV's GrabCut, which builds its own graph
/// (of 8-bit BGR, with OpenCV's weights). So it uses only `most_px` and `rounds`. It needs some 0.1
/// s for this size.
inline constexpr CutWeights kCutOfClick{.most_px = 25e3, .rounds = 4};
/// More masks at a click (candidates). A cut lasts 5 to 10 ms.
inline constexpr CutWeights kCutOfCandidate{.most_px = 12e3,
                                            .rounds = 4,
                                            .most_color = 6.0F,
                                            .plane = -1.5F,
                                            .skin = -1.5F,
                                            .other_depth = -2.0F,
                                            .own_depth = 0.5F,
                                            .hole = 2.5F,
                                            .beside_object = 0.7F};
/// Search for a lost object (redetect). It costs 5 to 8 ms.
inline constexpr CutWeights kCutOfRedetection{.most_px = 9e3,
                                              .color = 1.5F,
                                              .plane = -2.0F,
                                              .skin = -3.0F,
                                              .other_depth = -3.0F,
                                              .per_px = 0.04F,
                                              .farthest_px = 20.0F};
/// Correction of a mask by the author's points (refine_clicks).
inline constexpr CutWeights kCutOfCorrection{
    .most_px = 20e3, .most_color = 4.0F, .far_color = 0.5F, .old_mask = 1.0F, .point = 1.5F};

/// Input of a cut. The images have the size of the view. Seeds are masks (0/255); empty: no seeds.
struct CutTerms {
  cv::Mat evidence;      ///< sum of a pixel's evidence, CV_32FC1, nats, above 0 for the object
  cv::Mat object{};      ///< seeds: certainly the object
  cv::Mat background{};  ///< seeds: certainly not the object, except where `object` is set
};

/// Returns a mask (255: object) by the minimum cut of the graph of all pixels. The cut minimises
/// the sum of the evidence in `terms` against the mask, and of the costs of its border. A border
/// between pixels of similar colour and depth costs most.
cv::Mat minimumCut(const CutTerms& terms, const GraphRoi& view, const DepthNoise& noise,
                   const CutWeights& weights);

}  // namespace hapticast::server
