// SPDX-License-Identifier: MIT
// Segmentation of real scenes: a careful start, then the mask carried with the object and a band
// around its contour decided anew in every frame; lost, it is looked for by its colours and found
// again under a new id. Thread: the one that runs Vision.
#pragma once

#include <deque>
#include <map>
#include <vector>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/follow/tracked_mask.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

/// What a clip starts with, and the frame that it was found in. The images are shared with whoever
/// has them: nobody writes into them.
struct InitialState {
  cv::Mat color;
  cv::Mat depth;
  std::vector<TrackedMask> objects;
  SceneContext scene;
};

class NarrowBandTracker final : public Segmenter {
 public:
  /// `next_id` and `lessons` as in makeSegmenter().
  NarrowBandTracker(const VisionSettings& settings, std::uint32_t& next_id,
                    ClipAnnotations* annotations);
  std::vector<Segment> next(const FramePair& frames, const Flows& flows) override;
  [[nodiscard]] bool hasAnnotation(const FramePair& frames) const override;

 private:
  void forgetScene();
  void decide(const FramePair& frames, const Flows& flows);
  void updateObjects(const FrameImages& images, const Flows& flows);
  void updatePlanes(const FrameImages& images);
  void removePlanes(const TrackedMask& object, const FrameImages& images);
  void startAtPoints(const FrameImages& images);
  [[nodiscard]] bool choosesByItself(const FramePair& frames) const;
  void chooseByItself(const FrameImages& images);
  void add(TrackedMask object, int number);
  /// Whether what was just found is an object that is followed already.
  [[nodiscard]] bool isAnother(const TrackedMask& found) const;
  void shareOut();
  void remember(const FrameImages& images);
  bool recall(const FrameImages& images);

  // The author's words (band_author.cpp).
  [[nodiscard]] const std::vector<PropagatedMask>* propagatedMasks(const FramePair& frames) const;
  void adoptTaught(const FrameImages& images, const std::vector<PropagatedMask>& masks);
  void applyAnnotation(const Annotation& annotation, const FramePair& frames);
  void applyPoint(const cv::Point& point, const Annotation& annotation, const FramePair& frames);
  void place(int number, const cv::Mat& mask, const FrameImages& images, bool given);
  TrackedMask* findObjectAt(const cv::Point& point);
  void keepHistory(const FramePair& frames);
  void propagate(TrackedMask& object, const FramePair& frames, bool given);
  void propagateBackwards(TrackedMask object, const FramePair& frames, std::uint64_t until,
                          bool given);

  struct Past {
    std::uint64_t index;
    FrameImages images;
    std::map<int, cv::Mat> masks;  // as followed forwards, by object number
  };

  AnnotationTrack annotation_track_;
  std::uint32_t& next_id_;
  ClipAnnotations* annotations_;
  std::deque<Past> past_;  // while the clip is looked through and more is said
  std::map<int, std::uint64_t> last_annotation_;  // the frame of it, by object number
  SceneContext scene_;
  std::vector<TrackedMask> objects_;
  int frame_ = 0;
  int planes_frame_ = 0;
  bool new_scene_ = true;
};

}  // namespace hapticast::server
