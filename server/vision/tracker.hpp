// SPDX-License-Identifier: MIT
// The part of vision that does not need the clip's range: frame in, objects with their surface and
// pose out. Used once to scan a clip and once to broadcast it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "server/vision/base/scene_cut.hpp"
#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/pose_tracker.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/segment/segment.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/surface/hold.hpp"

namespace hapticast::server {

struct TrackedObject {
  std::uint32_t id = 0;
  bool seen = true;  ///< false: lost, kept where it was last seen
  Surface surface;
  Pose pose;
  CellFlow cells;  ///< empty where the plan or the method does without
  double quality = 1.0;
  double visible_fraction = 1.0;
  /// What is left out; never null.
  std::shared_ptr<ScenePlan> plan = std::make_shared<ScenePlan>(PlanSettings{}, false);
  double held_share = 0.0;  ///< 0..1, the part of the surface that is held; 1: all of it is at rest
                            ///< and equals the last frame's

  [[nodiscard]] bool atRest() const { return held_share >= 1.0; }
};

class Tracker {
 public:
  /// `next_id` is counted up; it and `remembered` must outlive the tracker. `settings` and `info`
  /// are copied.
  Tracker(const SourceInfo& info, const VisionSettings& settings, std::uint32_t& next_id,
          RememberedStart& remembered);

  /// The objects of the next frame, also those just lost (for kKeepLost frames, quality falling to
  /// 0). Throws SourceError (a frame that does not fit the announcement, an object point on
  /// nothing).
  std::vector<TrackedObject> next(const RgbdFrame& frame, double time_s);
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  /// Whether the last frame shows another scene than those before: its objects are all new.
  [[nodiscard]] bool sceneCut() const { return scene_cut_; }

  static constexpr int kKeepLost = 5;  ///< frames

 private:
  struct Track {
    std::uint32_t id = 0;
    PoseTracker motion;
    TrackedObject now;
    cv::Mat mask;
    double full_area_px = 0.0;  // of the whole object, at its present size
    int lost = 0;
    bool stays = false;  // in this frame nothing of it has changed
    cv::Vec2d last_step{0, 0};
    Hold hold;
    cv::Vec2d background_px{0, 0};  // how far it has moved behind the object
  };

  void learnNoise(const View& view);
  void forgetScene(const View& view);
  [[nodiscard]] Flows followTracks(const View& view);
  /// How far the background has moved, for those who feel its motion taken off.
  void followBackground(const View& view);
  void segment(const View& view, const Flows& flows);
  [[nodiscard]] Surface surfaceOf(const Segment& segment, const View& view, ScenePlan& plan) const;
  [[nodiscard]] static Surface carriedSurface(const Segment& segment, const Surface& before,
                                              const ObjectFlow& flow);
  [[nodiscard]] PlanSettings planSettings() const;
  /// Whether the frame shows the track as it is held, all of it at rest, and its plan leaves out
  /// what would look at it again.
  bool staysAtRest(Track& track, const View& view) const;
  [[nodiscard]] bool depthRepeats(const View& view, const cv::Mat& mask,
                                  const ObjectFlow& flow) const;
  void start(const Segment& segment, const View& view, double time_s);
  void update(const Segment& segment, const View& view, const Flows& flows, double time_s);
  /// The thesis's dense flow, or what the rigid motion leaves over.
  void measureCells(Track& track, const View& view, const Surface& before, double time_s);
  /// Holds what is at rest of the track's new surface; does nothing where there is no noise.
  [[nodiscard]] RestNoise restNoise(double depth_mm) const;
  void hold(Track& track, const View& view, bool repeated) const;
  static void updatePresence(Track& track, const Segment& segment, const ObjectFlow& flow);

  SourceInfo info_;
  VisionSettings settings_;
  std::uint32_t& next_id_;
  RememberedStart& remembered_;
  bool exact_masks_ = false;
  std::unique_ptr<Segmenter> segmenter_;
  DepthNoise noise_;
  SceneCuts scene_cuts_;
  bool scene_cut_ = false;
  View last_;
  cv::Mat last_small_gray_;  // for the background
  cv::Vec2d last_background_step_px_{0, 0};
  double last_time_s_ = 0.0;
  std::vector<Segment> last_segments_;
  std::vector<Track> tracks_;
};

}  // namespace hapticast::server
