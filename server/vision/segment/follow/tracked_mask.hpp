// SPDX-License-Identifier: MIT
// State of one object in narrow-band tracking: its mask, its part hidden by nearer surfaces, and
// its appearance model. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Scene model that all objects of a frame share.
struct SceneContext {
  DepthNoise noise;
  std::vector<Plane> planes;
  SkinColors skin;
  NegativeColors avoided;

  [[nodiscard]] FrameContext view(const FrameImages& images) const {
    return {images, planes, noise, skin};
  }
};

/// One tracked object.
class TrackedMask {
 public:
  /// Starts with a first mask (CV_8UC1, 0/255, image size). Repeats the band step on this frame
  /// until the mask converges, at most `most_rounds` times.
  TrackedMask(std::uint32_t id, const cv::Mat& first_mask, const FrameImages& images,
              const SceneContext& scene, int most_rounds = kSettleRounds);
  static constexpr int kSettleRounds = 25;  ///< measured: 5 to 19 are needed

  /// Stores the score of the present mask as the reference for later comparisons.
  void rememberAppearance(const FrameImages& images, const SceneContext& scene);
  /// Returns the score of `mask` as this object; see reidentificationScore().
  [[nodiscard]] double likeness(const FrameImages& images, const SceneContext& scene,
                                const cv::Mat& mask) const;
  /// Corrects the mask by the author's points: positive ones belong to the object, negative ones do
  /// not. Loses the object if no pixel remains.
  void correct(const FrameImages& images, const SceneContext& scene, const Annotation& annotation);
  /// Adopts `mask` as the object's mask and computes the appearance model anew. `given`: a key
  /// mask, which contains no hand.
  void adopt(const cv::Mat& mask, const FrameImages& images, const SceneContext& scene, bool given);
  /// Updates the mask for the next frame: moves it by `flow` and decides its band anew.
  void update(const FrameImages& images, const ObjectFlow& flow, const SceneContext& scene);
  /// Counts a frame of loss. Every third such frame it searches the whole picture, by the first
  /// colours and near the last depth. Returns the object if found, without a new id yet; else
  /// nullopt.
  [[nodiscard]] std::optional<TrackedMask> search(const FrameImages& images,
                                                  const SceneContext& scene);
  /// Removes the pixels that `other` has too. Loses the object if almost none remains.
  void yieldTo(const TrackedMask& other);
  /// Marks the object as lost.
  void lose();
  /// Returns the share of its pixels, 0..1, that `other` has too.
  [[nodiscard]] double overlapShare(const TrackedMask& other) const;

  [[nodiscard]] std::uint32_t id() const { return id_; }
  void rename(std::uint32_t id) { id_ = id; }
  /// The author's number of the object: n for the n-th point, and for the value n of a key mask.
  /// Constant.
  [[nodiscard]] int number() const { return number_; }
  void setNumber(int number) { number_ = number; }
  /// Mask of the visible part: CV_8UC1, 0/255, image size.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// 1: decided in this frame; less: only propagated.
  [[nodiscard]] double quality() const { return quality_; }
  /// Returns whether the last frame's mask was decided by its pixels; false: only propagated.
  [[nodiscard]] bool isDecided() const { return weak_ == 0; }
  [[nodiscard]] bool present() const { return lost_ == 0; }
  [[nodiscard]] int framesLost() const { return lost_; }

 private:
  TrackedMask() = default;
  void forgetColors(const SceneContext& scene);
  void relax(const FrameImages& images, const SceneContext& scene, int most_rounds);
  void learnAppearance(const ObjectRoi& patch, const FrameImages& images, const SceneContext& scene,
                       double most_skin);
  void isSeenWell(const ObjectRoi& patch);
  [[nodiscard]] ObjectLimits limits(const SceneContext& scene) const;
  [[nodiscard]] bool convinces(const ContourResult& now, double expected_px) const;
  [[nodiscard]] ObjectRoi expected(const FrameImages& images, const cv::Matx23d& similarity,
                                   const SceneContext& scene) const;
  void setMask(const cv::Mat& seen, const ObjectRoi& patch, const FrameImages& images);
  bool redetectObject(const FrameImages& images, const SceneContext& scene);

  std::uint32_t id_ = 0;
  int number_ = 0;
  cv::Mat mask_;
  cv::Mat whole_;  // the mask with the part that nearer surfaces hide
  ContourMemory memory_;
  double quality_ = 1.0;
  int weak_ = 0;        // successive frames without a plausible decision
  int lost_ = 0;        // frames since the loss; 0: present
  double area_px_ = 0;  // in its last good frame
  double usual_px_ = 0;
  int since_search_ = 0;   // frames
  double likeness_ = 0.0;  // score of its initial mask
  DepthSpan depth_;
  ColorHistogram own_;      // of added pixels: no hand, even if skin-coloured
  bool like_skin_ = false;  // its colours resemble skin
};

}  // namespace hapticast::server
