// SPDX-License-Identifier: MIT
// Segmentation of real scenes: a careful start, then the mask carried with the object and a band
// around its contour decided anew in every frame; lost, it is looked for by its colours and found
// again under a new id. Thread: the one that runs Vision.
#pragma once

#include <vector>

#include "server/vision/segment/band_object.hpp"
#include "server/vision/segment/segment.hpp"

namespace hapticast::server {

/// What a clip starts with, and the frame that it was found in. The images are shared with whoever
/// has them: nobody writes into them.
struct BandStart {
  cv::Mat color;
  cv::Mat depth;
  std::vector<BandObject> objects;
  BandScene scene;
};

class BandSegmenter final : public Segmenter {
 public:
  /// `next_id` and `remembered` as in makeSegmenter().
  BandSegmenter(const VisionSettings& settings, std::uint32_t& next_id,
                RememberedStart* remembered);
  std::vector<Segment> next(const FramePair& frames, const Flows& flows) override;

 private:
  void forgetScene();
  void decide(const FramePair& frames, const Flows& flows);
  void followObjects(const FrameImages& images, const Flows& flows);
  void followPlanes(const FrameImages& images);
  void removePlanesOf(const BandObject& object, const FrameImages& images);
  void startAtPoints(const FrameImages& images);
  void chooseByItself(const FrameImages& images);
  void add(BandObject object);
  /// Whether what was just found is an object that is followed already.
  [[nodiscard]] bool isAnother(const BandObject& found) const;
  void shareOut();
  void remember(const FrameImages& images) const;
  bool recall(const FrameImages& images);

  std::vector<Vec2> points_;
  std::vector<cv::Point> not_points_;
  std::uint32_t& next_id_;
  RememberedStart* remembered_;
  BandScene scene_;
  std::vector<BandObject> objects_;
  int frame_ = 0;
  int planes_frame_ = 0;
  bool new_scene_ = true;
};

}  // namespace hapticast::server
