// SPDX-License-Identifier: MIT
// One object as the band step follows it: where it is, what something nearer hides of it, and what
// is remembered of its looks. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/appearance/graph_roi.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// What the objects of a frame stand in.
struct SceneContext {
  DepthNoise noise;
  std::vector<Plane> planes;
  SkinColors skin;
  NegativeColors avoided;

  [[nodiscard]] FrameContext view(const FrameImages& images) const {
    return {images, planes, noise, skin};
  }
};

class TrackedMask {
 public:
  /// Starts with a first mask (0 / 255, size of the picture), which is settled: the band step is
  /// repeated on this frame until it comes to rest, `most_rounds` times at most.
  TrackedMask(std::uint32_t id, const cv::Mat& first_mask, const FrameImages& images,
              const SceneContext& scene, int most_rounds = kSettleRounds);
  static constexpr int kSettleRounds = 25;  ///< measured: 5 to 19 are needed

  /// Learns how much it looks like itself, by which it is told from others later.
  void rememberAppearance(const FrameImages& images, const SceneContext& scene);
  /// How much `mask` is like one thing, and this one; see resemblance().
  [[nodiscard]] double likeness(const FrameImages& images, const SceneContext& scene,
                                const cv::Mat& mask) const;
  /// Decides it anew by the author's points: what is on them is it, or none of it. Lost where
  /// nothing is left.
  void correct(const FrameImages& images, const SceneContext& scene, const Annotation& annotation);
  /// From now on it is where the author's word says, and looks as it does there: its colours are
  /// learnt anew. A mask that was `given` has no hand in it.
  void adopt(const cv::Mat& mask, const FrameImages& images, const SceneContext& scene, bool given);
  /// The mask in the next frame, moved by `flow`, its band decided anew.
  void update(const FrameImages& images, const ObjectFlow& flow, const SceneContext& scene);
  /// Counts a frame in which it is lost; every third one it is looked for over the whole picture,
  /// by its first colours and near its last depth. Found again it is another object, without an id
  /// yet.
  [[nodiscard]] std::optional<TrackedMask> search(const FrameImages& images,
                                                  const SceneContext& scene);
  /// Leaves to `other` the pixels that both have; lost when next to nothing is left.
  void yieldTo(const TrackedMask& other);
  void lose();
  /// The part of its pixels, 0..1, that `other` has, too.
  [[nodiscard]] double overlapShare(const TrackedMask& other) const;

  [[nodiscard]] std::uint32_t id() const { return id_; }
  void rename(std::uint32_t id) { id_ = id; }
  /// By what the author means it: n for the n-th point, and for n in a drawn mask. Stays for good.
  [[nodiscard]] int number() const { return number_; }
  void setNumber(int number) { number_ = number; }
  /// Where it is seen: 0 / 255, size of the picture.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// 1: decided from this frame; less: carried on.
  [[nodiscard]] double quality() const { return quality_; }
  /// Whether its last frame was decided from what is seen there; else it was carried on.
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
  cv::Mat whole_;  // mask and what of the object something nearer hides
  ContourMemory memory_;
  double quality_ = 1.0;
  int weak_ = 0;        // frames in a row that did not convince
  int lost_ = 0;        // frames since it was lost; 0: present
  double area_px_ = 0;  // when last seen well
  double usual_px_ = 0;
  int since_search_ = 0;   // frames
  double likeness_ = 0.0;  // resemblance to itself at the start
  DepthSpan depth_;
  ColorHistogram own_;  // of what the author added to it: no hand, although it may look like one
  bool like_skin_ = false;  // its colours are like those of hands
};

}  // namespace hapticast::server
