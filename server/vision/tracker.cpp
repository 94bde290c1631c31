// SPDX-License-Identifier: MIT
#include "server/vision/tracker.hpp"
#include "server/vision/segment/make_segmenter.hpp"

#include <algorithm>

namespace hapticast::server {

namespace {

// Field of view of a usual camera, for sources without camera data. An error of a fifth costs 2 to
// 3 % of the acceleration (measured on scenes with exact truth).
constexpr double kUsualFieldOfView_deg = 56.0;

}  // namespace

CameraModel selectCamera(const SourceInfo& info, const VisionSettings& settings) {
  if (settings.camera) return *settings.camera;
  if (info.camera && !settings.fov_deg) return *info.camera;
  return CameraModel::ofFieldOfView(settings.fov_deg.value_or(kUsualFieldOfView_deg), info.width_px,
                                    info.height_px);
}

namespace {

PoseSettings poseSettings(const SourceInfo& info, const VisionSettings& settings) {
  PoseSettings out;
  out.mode = settings.moves() ? settings.motion : MotionMode::kNone;
  out.rigid = settings.method == Method::kHapticast &&
              (out.mode == MotionMode::kAuto || out.mode == MotionMode::kRgbd);
  out.camera = selectCamera(info, settings);
  out.picture = {info.width_px, info.height_px};
  return out;
}

}  // namespace

Tracker::Tracker(const SourceInfo& info, const VisionSettings& settings, const Clock* clock,
                 std::uint32_t& next_id, ClipAnnotations& annotations)
    : settings_{settings, poseSettings(info, settings), false, clock},
      next_id_(next_id),
      annotations_(info.live ? nullptr : &annotations),
      frames_(info, !settings.plan.everything) {}

std::vector<TrackedObject> Tracker::next(const RgbdFrame& frame, double time_s) {
  const FramePair frames = frames_.push(frame, time_s, objectsMask());
  scene_cut_ = frames.cut;
  if (scene_cut_) {
    tracks_.clear();
    segments_.clear();
    background_ = {};
  }
  bool all_rest = !tracks_.empty() || frames.identical;
  const bool annotated = segmenter_ != nullptr && segmenter_->hasAnnotation(frames);
  for (Track& track : tracks_) all_rest = track.isResting(frames, annotated) && all_rest;
  if (!all_rest) segment(frames);
  if (settings_.vision.compensate_pan) updateBackground(frames);
  updateTracks(frames);
  std::vector<TrackedObject> out;
  for (const Track& track : tracks_) {
    if (out.size() < kMaxObjects) out.push_back(track.object());
  }
  return out;
}

void Tracker::decideStages(std::vector<TrackedObject>& objects) const {
  for (TrackedObject& object : objects) {
    for (const Track& track : tracks_) {
      if (track.object().id == object.id) track.decideStages(object);
    }
  }
}

void Tracker::report(std::uint32_t id, const StageReport& report) {
  for (Track& track : tracks_) {
    if (track.object().id == id) track.report(report);
  }
}

std::map<std::uint32_t, std::vector<PlanLine>> Tracker::plans() const {
  std::map<std::uint32_t, std::vector<PlanLine>> out;
  for (const Track& track : tracks_) out[track.object().id] = track.plan().lines();
  return out;
}

cv::Mat Tracker::objectsMask() const {
  cv::Mat out;
  for (const Track& track : tracks_) out = out.empty() ? track.mask() : cv::Mat(out | track.mask());
  return out;
}

void Tracker::segment(const FramePair& frames) {
  if (segmenter_ == nullptr) {
    const bool has_mask = !frames.now.mask.empty();
    const SegmentMode mode = settings_.vision.segment;
    settings_.exact_masks = settings_.pose.exact_masks =
        has_mask && (mode == SegmentMode::kAuto || mode == SegmentMode::kSource);
    segmenter_ = makeSegmenter(settings_.vision, has_mask, next_id_, annotations_);
  }
  Flows flows;
  for (Track& track : tracks_) flows[track.object().id] = track.computeFlow(frames);
  const Clock* clock = settings_.clock;
  const LocalTime start = clock != nullptr ? clock->now() : LocalTime();
  segments_ = segmenter_->next(frames, flows);
  if (clock == nullptr || tracks_.empty()) return;
  StageReport each;
  each.times[std::size_t(Stage::kSegment)] =
      (clock->now() - start) / static_cast<int>(tracks_.size());
  for (Track& track : tracks_) track.report(each);
}

void Tracker::updateBackground(const FramePair& frames) {
  if (frames.identical) return;
  std::vector<BackgroundMotion::Object> objects;
  for (const Track& track : tracks_) {
    const ObjectPose& pose = track.object().pose;
    objects.push_back({track.mask(), {pose.u_px, pose.v_px}});
  }
  const std::vector<cv::Vec2d> steps_px = background_.next(frames.now.gray, objects);
  for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].addBackground(steps_px[i]);
}

void Tracker::updateTracks(const FramePair& frames) {
  const auto segmentOf = [this](std::uint32_t id) {
    return std::find_if(segments_.begin(), segments_.end(),
                        [id](const Segment& segment) { return segment.id == id; });
  };
  std::vector<std::uint32_t> known;
  for (Track& track : tracks_) {
    known.push_back(track.object().id);
    const auto own = segmentOf(track.object().id);
    if (own != segments_.end()) {
      track.update(*own, frames);
    } else {
      track.lose();
    }
  }
  std::erase_if(tracks_, [](const Track& track) { return track.isGone(); });
  for (const Segment& segment : segments_) {
    const bool is_new = std::find(known.begin(), known.end(), segment.id) == known.end();
    // Without depth there is no surface to touch yet.
    if (is_new && hasDepth(frames.now.depth, segment.mask))
      tracks_.emplace_back(settings_, segment, frames);
  }
  for (Track& track : tracks_) track.endFrame();
}

}  // namespace hapticast::server
