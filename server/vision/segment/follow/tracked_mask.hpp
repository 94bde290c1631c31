// SPDX-License-Identifier: MIT
// State of one object in narrow-band tracking: the mask of its visible part, the mask of the part
// that nearer surfaces hide, and its appearance model. Thread: the one that runs Vision.
#pragma once

#include <algorithm>
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

/// Limits of the similarity between a lost object and a candidate for it.
struct LikeLimits {
  double less;    ///< largest decrease of its reidentificationScore()
  double colors;  ///< least overlap of its colours with those of the first mask
};

/// Largest area of a corrected or found mask, of the object's usual area. The value is a choice.
inline constexpr double kMostAgain = 1.6;
/// Frames from one search in the whole picture to the next one. The value is a choice: it costs
/// twice as much as a search nearby.
inline constexpr int kSearchEverywhere = 3;

/// Mask and appearance of one object, updated from frame to frame.
class TrackedMask {
 public:
  /// Begins with the mask `first_mask` (CV_8UC1, 0/255, size of the image). Repeats the decision of
  /// the band's pixels in this one frame until the mask hardly changes, at most `most_rounds`
  /// times.
  TrackedMask(std::uint32_t id, const cv::Mat& first_mask, const FrameImages& images,
              const SceneContext& scene, int most_rounds = kSettleRounds);
  /// Default of `most_rounds`. In measurements, the mask needed 5 to 19 repetitions.
  static constexpr int kSettleRounds = 25;

  /// Stores the reidentificationScore() of the present mask. search() compares later masks with it.
  void rememberAppearance(const FrameImages& images, const SceneContext& scene);
  /// Returns the reidentificationScore() of `mask` for this object.
  [[nodiscard]] double computeLikeness(const FrameImages& images, const SceneContext& scene,
                                       const cv::Mat& mask) const;
  /// Corrects the mask by the author's points: pixels around positive points belong to the object,
  /// those around negative points do not. Regions of visible anchors remain. Marks the object as
  /// lost in three cases: the mask was only moved and `annotation` has only negative points; no
  /// visible anchor exists and almost no pixel remains; no anchor exists and the remaining colours
  /// are not those of the object.
  void correct(const FrameImages& images, const SceneContext& scene, const Annotation& annotation);
  /// Replaces the object's mask by `mask` and computes the appearance model anew.
  void adopt(const cv::Mat& mask, const FrameImages& images, const SceneContext& scene);
  /// Adds a point of the author on the object, px of this picture. The point moves with the object,
  /// and later corrections keep its region. A later --not beside the point removes it. So does a
  /// motion after which the point is outside the object.
  void addAnchor(const cv::Point& point) { anchors_.emplace_back(point); }
  /// Learns the colours of the hand that holds the object: those of `color` (CV_8UC3) where `hand`
  /// (CV_8UC1, 0/255) is set. From then on they are evidence against the object, unless the object
  /// has them too. Does nothing for fewer than 40 pixels of `hand`, or if the room has the same
  /// colours. update() learns them itself when a hand first touches the object.
  void learnHand(const cv::Mat& color, const cv::Mat& hand);
  /// Updates the mask for the next frame: moves the mask by `flow` and decides the pixels of its
  /// band anew. `box`: place of the object according to BoxTracker, px; nullopt: unknown.
  void update(const FrameImages& images, const ObjectFlow& flow, const SceneContext& scene,
              const std::optional<cv::Rect>& box = std::nullopt);
  /// Counts a frame in which the object is lost. Searches for the object by redetect() near its
  /// last place, then around `box` (see update()), and in every third such frame in the whole
  /// picture. The search covers depths of 0.6 to 1.6 times the object's last depth. Returns the
  /// object if it was found, still without a new id; otherwise nullopt.
  [[nodiscard]] std::optional<TrackedMask> search(
      const FrameImages& images, const SceneContext& scene,
      const std::optional<cv::Rect>& box = std::nullopt);
  /// Removes from this mask the pixels that the mask of `other` also contains. Marks the object as
  /// lost if almost none remains.
  void yieldTo(const TrackedMask& other);
  /// Marks the object as lost.
  void lose();
  /// Returns the share of this object's pixels, 0..1, that the mask of `other` also contains.
  [[nodiscard]] double overlapShare(const TrackedMask& other) const;

  [[nodiscard]] std::uint32_t id() const { return id_; }
  void rename(std::uint32_t id) { id_ = id; }
  /// Returns the object's number, which is constant. Number n belongs to the author's n-th point,
  /// or to the value n of a key mask.
  [[nodiscard]] int number() const { return number_; }
  void setNumber(int number) { number_ = number; }
  /// Returns the mask of the visible part: CV_8UC1, 0/255, size of the image.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// Returns 1 if the mask was decided by the newest frame's pixels and the motion was measured.
  /// Otherwise returns less than 1.
  [[nodiscard]] double quality() const { return quality_; }
  /// Returns the mask, with its hidden part, of the last frame whose pixels decided it.
  [[nodiscard]] const cv::Mat& lastSure() const { return last_sure_; }
  /// Returns whether the pixels of the newest frame decided the mask. Returns false if the mask was
  /// only moved.
  [[nodiscard]] bool isDecided() const { return weak_ == 0; }
  /// Returns those anchors that the visible mask contains, px.
  [[nodiscard]] std::vector<cv::Point> visibleAnchors() const;
  [[nodiscard]] bool present() const { return lost_ == 0; }
  [[nodiscard]] int framesLost() const { return lost_; }
  /// Returns whether the object is lost because its mask stayed on the background: then it is not
  /// at its last place.
  [[nodiscard]] bool isPlaceRefuted() const { return is_place_refuted_; }

 private:
  TrackedMask() = default;
  void forgetColors(const SceneContext& scene);
  void relax(const FrameImages& images, const SceneContext& scene, int most_rounds);
  // `is_whole`: nothing hides a part of the object.
  void learnAppearance(const ObjectRoi& patch, const FrameImages& images, const SceneContext& scene,
                       bool is_whole);
  void resetToVisible(const ObjectRoi& patch);
  [[nodiscard]] ObjectLimits limits(const SceneContext& scene) const;
  [[nodiscard]] bool convinces(const ContourResult& now, double expected_px) const;
  [[nodiscard]] bool isJump(const cv::Matx23d& similarity) const;
  [[nodiscard]] std::optional<TrackedMask> searchIn(const cv::Rect& window, const LikeLimits& least,
                                                    const FrameImages& images,
                                                    const SceneContext& scene) const;
  [[nodiscard]] std::optional<TrackedMask> searchElsewhere(const FrameImages& images,
                                                           const SceneContext& scene) const;
  [[nodiscard]] ObjectRoi locate(const FrameImages& images, const SceneContext& scene,
                                 const std::optional<cv::Rect>& box, cv::Matx23d& similarity) const;
  void checkPresence(const ObjectRoi& patch, const cv::Matx23d& similarity, bool nothing,
                     const FrameImages& images, const SceneContext& scene);
  void dropDetachedPieces(const ObjectRoi& patch, cv::Mat& mask);
  void learnTouchingHand(const ObjectRoi& patch, const cv::Mat& mask, const SceneContext& scene);
  [[nodiscard]] bool isLeftBehind(const ObjectRoi& patch, const cv::Matx23d& similarity,
                                  const FrameImages& images, const SceneContext& scene);
  void moveAnchors(const cv::Matx23d& similarity);
  void setMask(const cv::Mat& seen, const ObjectRoi& patch, const FrameImages& images);
  bool redetectObject(const FrameImages& images, const SceneContext& scene);

  std::uint32_t id_ = 0;
  int number_ = 0;
  cv::Mat mask_;
  cv::Mat whole_;  // the mask with the part that nearer surfaces hide
  ContourMemory memory_;
  cv::Mat last_sure_;  // whole_ of the last frame whose pixels decided the mask
  cv::Matx23d last_similarity_ = cv::Matx23d::eye();  // motion in the last frame
  double quality_ = 1.0;
  int weak_ = 0;        // successive frames without a plausible decision
  int lost_ = 0;        // frames since the loss; 0: present
  double area_px_ = 0;  // area in its last frame with a plausible mask
  double usual_px_ = 0;
  int detached_ = 0;  // successive frames with a mask of several pieces
  int doubtful_ = 0;  // successive frames with colours that are not the object's
  bool is_place_refuted_ = false;
  double likeness_ = 0.0;  // score of its initial mask
  DepthSpan depth_;
  std::vector<cv::Point2f> anchors_;  // points of the author on the object, px
};

/// Returns the object of `objects` with this number, present or lost; null if there is none.
template <class Objects>
auto* findNumbered(Objects& objects, int number) {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [number](const TrackedMask& o) { return o.number() == number; });
  return found != objects.end() ? &*found : nullptr;
}

}  // namespace hapticast::server
