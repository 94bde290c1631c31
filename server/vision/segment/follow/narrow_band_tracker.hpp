// SPDX-License-Identifier: MIT
// Narrow-band tracking for real scenes. It begins with an initial mask. In each frame it moves the
// mask with the object, and decides the pixels of a band around the contour anew. The tracker
// searches for a lost object by its colours (re-detection). An object that is found again has a new
// id. Thread: the one that runs Vision.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/follow/box_tracker.hpp"
#include "server/vision/segment/follow/select_initial_mask.hpp"
#include "server/vision/segment/follow/tracked_mask.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

/// Objects and scene model at the start of a clip, with the images of that frame. These images are
/// shared and read-only.
struct InitialState {
  cv::Mat color;
  cv::Mat depth;
  std::vector<TrackedMask> objects;
  SceneContext scene;
};

/// Segmenter for clips and live sources without masks.
class NarrowBandTracker final : public Segmenter {
 public:
  /// Creates a segmenter without objects; the first call of next() finds them. `next_id` and
  /// `annotations`: see makeSegmenter().
  NarrowBandTracker(const VisionSettings& settings, std::uint32_t& next_id,
                    ClipAnnotations* annotations);
  std::vector<Segment> next(const FramePair& frames, const Flows& flows) override;
  [[nodiscard]] bool hasAnnotation(const FramePair& frames) const override;

 private:
  void forgetScene();
  void decide(const FramePair& frames, const Flows& flows);
  void updateObjects(const FramePair& frames, const Flows& flows);
  std::optional<cv::Rect> followBox(const TrackedMask& object, const FramePair& frames);
  void updatePlanes(const FrameImages& images);
  void removePlanes(const TrackedMask& object, const FrameImages& images);
  void startAtPoints(const FrameImages& images);
  [[nodiscard]] bool choosesByItself(const FramePair& frames) const;
  void chooseByItself(const FrameImages& images);
  void addStart(ChosenStart start, int number, const FrameImages& images);
  void add(TrackedMask object, int number);
  /// Returns whether `found` covers an object that is tracked already.
  [[nodiscard]] bool isAnother(const TrackedMask& found) const;
  void shareOut();
  void remember(const FrameImages& images);
  bool findAgain(const FrameImages& images);

  // Annotations of later frames (apply_annotations.cpp).
  [[nodiscard]] const std::vector<PropagatedMask>* findPropagatedMasks(
      const FramePair& frames) const;
  void adoptTaught(const FrameImages& images, const std::vector<PropagatedMask>& masks);
  void applyAnnotation(const Annotation& annotation, const FramePair& frames);
  void applyPoint(const ObjectPoint& point, const Annotation& annotation, const FramePair& frames);
  void place(int number, const cv::Mat& mask, const FrameImages& images);
  /// Corrects the mask of `object` in this frame and those before it.
  void correct(TrackedMask& object, const Annotation& annotation, const FramePair& frames);
  /// Replaces the chosen object by the candidate that the author picked.
  static void pickCandidate(ChosenStart& start, const ObjectPoint& point);
  void logChoice(const ChosenStart& start) const;
  TrackedMask* findObjectAt(const cv::Point& point);
  void keepHistory(const FramePair& frames);
  void propagate(TrackedMask& object, const FramePair& frames, bool given);
  void propagateBackwards(TrackedMask object, const FramePair& frames, std::uint64_t until,
                          bool given);

  struct Past {
    std::uint64_t index;
    FrameImages images;
    std::map<int, cv::Mat> masks;  // results of forward tracking, by object number
  };

  /// What follows an object whose mask is in doubt.
  struct Doubt {
    cv::Mat sure_color;  // picture of the last frame whose pixels decided the mask
    std::optional<BoxTracker> box{};
    int frames = 0;  // since then
  };

  AnnotationTrack annotation_track_;
  bool explain_;
  int named_;  // number of objects that the author's scene names
  std::uint32_t& next_id_;
  ClipAnnotations* annotations_;
  std::deque<Past> past_;  // earlier frames, during a scan with later annotations
  std::map<int, std::uint64_t> last_annotation_;  // frame of the last annotation, by object number
  SceneContext scene_;
  std::vector<TrackedMask> objects_;
  std::map<int, Doubt> doubts_;  // by object number
  int frame_ = 0;
  int planes_frame_ = 0;
  int next_choice_ = 0;  // frame of the next attempt at an automatic choice
  bool new_scene_ = true;
};

}  // namespace hapticast::server
