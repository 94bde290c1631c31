// SPDX-License-Identifier: MIT
#include "server/vision/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr double kRepeated = 0.98;
constexpr double kFewestDepth = 0.02;            // of the mask, to make a surface of
constexpr double kTooLittle = 0.25;              // visible fraction
constexpr double kBlindQuality = 0.5;            // at most: followed without depth
constexpr int kBesideObjects_px = 4;             // at half size: their rims are no background
constexpr double kStandingBackground_px = 0.03;  // a step of less is noise
constexpr double kCleanDrift = 0.1;              // steps of rounded depth

cv::Vec2d centroidOf(const cv::Mat& mask) {
  const cv::Rect box = boxAround(mask, 0);
  const cv::Moments moments = cv::moments(mask(box), true);
  return moments.m00 > 0
             ? cv::Vec2d(box.x + moments.m10 / moments.m00, box.y + moments.m01 / moments.m00)
             : cv::Vec2d(0, 0);
}

// Where the source does not know its camera: 56 degrees wide, as most are. Wrong by a fifth it
// costs 2 to 3 % of the acceleration (motion notes, section 2.3).
CameraModel usualCamera(const SourceInfo& info) {
  const double focal_px = 0.94 * info.width_px;
  return {focal_px, focal_px, 0.5 * info.width_px, 0.5 * info.height_px};
}

bool hasDepth(const View& view, const cv::Mat& mask) {
  const cv::Rect box = boxAround(mask, 0);
  return cv::countNonZero(mask(box) & (view.depth(box) > 0)) >=
         kFewestDepth * cv::countNonZero(mask(box));
}

}  // namespace

Tracker::Tracker(const SourceInfo& info, const VisionSettings& settings, std::uint32_t& next_id,
                 RememberedStart& remembered)
    : info_(info), settings_(settings), next_id_(next_id), remembered_(remembered) {}

void Tracker::learnNoise(const View& view) {
  noise_ = measureNoise(view.depth);
  noise_.eight_bit = info_.depth_kind == DepthKind::kHeight;
}

void Tracker::forgetScene(const View& view) {
  learnNoise(view);
  segmenter_->sceneCut();
  tracks_.clear();
  last_segments_.clear();
  last_ = {};
  last_small_gray_.release();
}

PlanSettings Tracker::planSettings() const {
  PlanSettings out = settings_.plan;
  if (settings_.motion == MotionMode::kNone) out.forced[std::size_t(Stage::kMotion)] = false;
  return out;
}

bool Tracker::staysAtRest(Track& track, const View& view) const {
  const ScenePlan& plan = *track.now.plan;
  const bool left_out = !plan.on(Stage::kMotion) && !plan.on(Stage::kSegment);
  if (settings_.method == Method::kThesis || track.lost > 0 || !track.now.atRest() || !left_out)
    return false;
  const double depth_mm = cv::mean(track.now.surface.depth, track.now.surface.mask)[0];
  return track.hold.stays(view.gray, view.depth, restNoise(depth_mm));
}

Flows Tracker::followTracks(const View& view) {
  Flows flows;
  if (exact_masks_ && settings_.motion == MotionMode::kNone) return flows;  // nobody asks
  for (Track& track : tracks_) {
    if (track.lost > 0) continue;
    ObjectFlow& flow = flows[track.id];
    flow.stays = track.stays;
    if (track.stays) continue;
    const Lap lap(settings_.clock, *track.now.plan, Stage::kMotion);
    // One tracker serves mask and motion; where it fails, corners tell where the mask went.
    if (!depthRepeats(view, track.mask, flow) && track.motion.find(view, flow)) continue;
    flow = trackObject(last_.gray, view.gray, track.mask, track.last_step);
  }
  return flows;
}

// The background's own flow, at half size: a pan is the same everywhere, and corners of half size
// are as good (motion notes, section 2.4).
void Tracker::followBackground(const View& view) {
  cv::Mat small;
  cv::resize(view.gray, small, {}, 0.5, 0.5, cv::INTER_AREA);
  std::swap(small, last_small_gray_);
  if (small.empty() || tracks_.empty()) return;
  cv::Mat background(view.gray.size(), CV_8UC1, cv::Scalar(255));
  for (const Track& track : tracks_) background.setTo(0, track.mask);
  cv::resize(background, background, small.size(), 0, 0, cv::INTER_NEAREST);
  background = erodedBy(background, kBesideObjects_px);
  const ObjectFlow flow =
      trackObject(small, last_small_gray_, background, 0.5 * last_background_step_px_);
  if (!flow.reliable) return;
  for (Track& track : tracks_) {
    const cv::Point2d at(0.5 * track.now.pose.u_px, 0.5 * track.now.pose.v_px);
    const cv::Point2d step = 2.0 * (flow.carry(at) - at);
    last_background_step_px_ = {step.x, step.y};
    if (cv::norm(step) > kStandingBackground_px) track.background_px += cv::Vec2d(step.x, step.y);
  }
}

void Tracker::segment(const View& view, const Flows& flows) {
  const LocalTime start = settings_.clock != nullptr ? settings_.clock->now() : LocalTime();
  last_segments_ = segmenter_->next(view, flows);
  if (settings_.clock == nullptr || tracks_.empty()) return;
  const Duration each = (settings_.clock->now() - start) / static_cast<int>(tracks_.size());
  for (Track& track : tracks_) track.now.plan->took(Stage::kSegment, each);
}

bool Tracker::depthRepeats(const View& view, const cv::Mat& mask, const ObjectFlow& flow) const {
  if (exact_masks_ || last_.depth.empty()) return false;
  const cv::Rect box = boxAround(mask, 8);
  const cv::Mat valid = view.depth(box) > 0;
  const cv::Mat same = (view.depth(box) == last_.depth(box)) & valid;
  if (cv::countNonZero(same) < kRepeated * cv::countNonZero(valid)) return false;
  const cv::Vec2d shift(flow.similarity(0, 2), flow.similarity(1, 2));
  return cv::norm(shift) > 0.3 ||
         cv::norm(view.gray(box), last_.gray(box), cv::NORM_L1) > 1.2 * box.area();
}

Surface Tracker::surfaceOf(const Segment& segment, const View& view, ScenePlan& plan) const {
  if (settings_.method == Method::kThesis)
    return cleanSurface(view.depth, segment.mask, noise_, settings_.method);
  const bool clean = plan.on(Stage::kClean);
  Surface raw;
  if (!clean || plan.measureNow()) {
    raw = rawSurface(view.depth, segment.mask, noise_);
    // A hole cannot be left as it is.
    if (!clean && !plan.measureNow() && equalImages(raw.measured, raw.mask)) return raw;
  }
  Surface cleaned;
  {
    const Lap lap(settings_.clock, plan, Stage::kClean);
    cleaned = cleanSurface(view.depth, segment.mask, noise_, settings_.method);
  }
  if (plan.measureNow()) {
    // A mask of our own may take in some background in any frame, not just in those that are
    // measured.
    const bool same = exact_masks_ && equalImages(cleaned.measured, raw.measured) &&
                      equalImages(raw.measured, raw.mask);
    plan.costs(Stage::kClean, same ? 0.0 : std::numeric_limits<double>::infinity());
  }
  return cleaned;
}

// The last relief carried by the motion: this depth is one frame old.
Surface Tracker::carriedSurface(const Segment& segment, const Surface& before,
                                const ObjectFlow& flow) {
  Surface out;
  out.box = boxAround(segment.mask, 0);
  out.mask = segment.mask(out.box).clone();
  out.measured =
      carryImage(before.measured, before.box, out.box, flow.similarity, cv::INTER_NEAREST) &
      out.mask;
  const cv::Mat depth =
      carryImage(before.depth, before.box, out.box, flow.similarity, cv::INTER_NEAREST);
  out.depth = filled(depth, out.measured & (depth > 0), out.mask);
  out.quantum_mm = before.quantum_mm;
  return out;
}

RestNoise Tracker::restNoise(double depth_mm) const {
  RestNoise out{noise_.at(depth_mm)};
  if (noise_.clean(depth_mm)) out.drift_mm = kCleanDrift * noise_.quantum_mm;
  return out;
}

void Tracker::hold(Track& track, const View& view, bool repeated) const {
  track.now.held_share = 0.0;
  if (settings_.method == Method::kThesis) return;
  Surface& surface = track.now.surface;
  const double depth_mm = cv::mean(surface.depth, surface.mask)[0];
  if (exact_masks_ && noise_.clean(depth_mm)) return;  // nothing trembles
  surface = track.hold.apply(view.gray, surface, restNoise(depth_mm), repeated);
  track.now.held_share = track.hold.share();
}

void Tracker::updatePresence(Track& track, const Segment& segment, const ObjectFlow& flow) {
  const cv::Rect box = track.now.surface.box;
  const double area = cv::countNonZero(track.now.surface.mask);
  const cv::Size picture = segment.mask.size();
  const bool entire =
      box.x > 0 && box.y > 0 && box.br().x < picture.width && box.br().y < picture.height;
  if (flow.rotation_reliable) track.full_area_px *= flow.scale() * flow.scale();
  // A whole object that stays smaller has become smaller; one cut by the border has not.
  if (entire) track.full_area_px += 0.05 * (area - track.full_area_px);
  track.full_area_px = std::max(track.full_area_px, area);
  track.now.visible_fraction = area / track.full_area_px;
  track.now.quality = segment.quality * (flow.reliable ? 1.0 : 0.8);
  // Of so little its motion cannot be told: its shape is felt, no force of its motion.
  if (track.now.visible_fraction < kTooLittle) track.now.quality = 0.0;
}

void Tracker::start(const Segment& segment, const View& view, double time_s) {
  TrackedObject first;
  first.id = segment.id;
  first.plan = std::make_shared<ScenePlan>(planSettings(), exact_masks_);
  first.surface = surfaceOf(segment, view, *first.plan);
  first.quality = segment.quality;
  const bool moves = settings_.plan.forced[std::size_t(Stage::kMotion)].value_or(true);
  const MotionMode mode = moves ? settings_.motion : MotionMode::kNone;
  const bool rigid = settings_.method == Method::kHapticast &&
                     (mode == MotionMode::kAuto || mode == MotionMode::kRgbd);
  PoseTracker motion(
      {mode, rigid, exact_masks_, info_.camera.value_or(usualCamera(info_)), view.gray.size()},
      view, first.surface);
  first.pose = motion.pose();
  first.cells.time_s = time_s;
  tracks_.push_back({segment.id,
                     motion,
                     first,
                     segment.mask,
                     double(cv::countNonZero(segment.mask)),
                     0,
                     false,
                     {0, 0},
                     {},
                     {0, 0}});
  hold(tracks_.back(), view, false);
}

void Tracker::update(const Segment& segment, const View& view, const Flows& flows, double time_s) {
  const auto known = std::find_if(tracks_.begin(), tracks_.end(),
                                  [&](const Track& t) { return t.id == segment.id; });
  if (known == tracks_.end()) {
    if (hasDepth(view, segment.mask)) start(segment, view, time_s);  // else nothing to touch yet
    return;
  }
  Track& track = *known;
  if (track.stays) {
    track.now.pose = track.motion.pose();
    track.now.held_share = 1.0;
    track.now.plan->rest(true);
    if (!track.now.cells.step.empty()) track.now.cells.step.setTo(0);
    return;
  }
  const auto found = flows.find(segment.id);
  const ObjectFlow flow = found != flows.end() ? found->second : ObjectFlow{};
  const bool blind = !hasDepth(view, segment.mask);
  const bool repeated = blind || depthRepeats(view, segment.mask, flow);
  const Surface before = track.now.surface;
  const Surface seen =
      repeated ? carriedSurface(segment, before, flow) : surfaceOf(segment, view, *track.now.plan);
  track.now.surface = seen;
  updatePresence(track, segment, flow);
  if (blind) track.now.quality = std::min(track.now.quality, kBlindQuality);
  hold(track, view, repeated);
  track.now.plan->rest(track.now.atRest());
  {
    const Lap lap(settings_.clock, *track.now.plan, Stage::kMotion);
    // Motion is measured on what this frame shows, not on what is held of the frames before.
    track.now.pose = track.motion.advance({.flow = flow,
                                           .view = view,
                                           .surface = seen,
                                           .repeated = repeated,
                                           .at_rest = track.now.atRest(),
                                           .visible_fraction = track.now.visible_fraction});
  }
  measureCells(track, view, before, time_s);
  track.last_step = centroidOf(segment.mask) - centroidOf(track.mask);
  track.mask = segment.mask;
}

void Tracker::measureCells(Track& track, const View& view, const Surface& before, double time_s) {
  CellFlow& cells = track.now.cells;
  cells = {};
  if (settings_.method == Method::kThesis) {
    if (settings_.motion != MotionMode::kNone)
      cells =
          cellFlow(last_.gray, view.gray, track.mask, before, track.now.surface, settings_.motion);
  } else if (track.motion.aligned() && track.now.plan->on(Stage::kGrid)) {
    const Lap lap(settings_.clock, *track.now.plan, Stage::kGrid);
    cells = residualFlow(last_.gray, view.gray, before, track.now.surface,
                         [&](const cv::Point2f& at_px, double depth_mm) {
                           return track.motion.explained(at_px, depth_mm);
                         });
  }
  cells.time_s = time_s;
  cells.interval_s = time_s - last_time_s_;
}

std::vector<TrackedObject> Tracker::next(const RgbdFrame& frame, double time_s) {
  const View view = makeView(frame, info_);
  if (segmenter_ == nullptr) {
    learnNoise(view);
    exact_masks_ = !view.mask.empty() && (settings_.segment == SegmentMode::kAuto ||
                                          settings_.segment == SegmentMode::kSource);
    segmenter_ = makeSegmenter(settings_, !view.mask.empty(), next_id_, &remembered_);
  }
  scene_cut_ = scene_cuts_.next(view);
  if (scene_cut_) forgetScene(view);
  const bool identical = !settings_.plan.everything && equalImages(view.color, last_.color) &&
                         equalImages(view.depth, last_.depth) && equalImages(view.mask, last_.mask);
  bool all_stay = identical || !tracks_.empty();
  for (Track& track : tracks_) {
    track.now.plan->nextFrame();
    track.stays = identical || staysAtRest(track, view);
    all_stay = all_stay && track.stays;
  }
  Flows flows;
  if (!all_stay) {
    flows = followTracks(view);
    segment(view, flows);
  }
  if (settings_.compensate_pan && !identical) followBackground(view);
  for (const Segment& segment : last_segments_) update(segment, view, flows, time_s);
  std::vector<TrackedObject> out;
  for (Track& track : tracks_) {
    const bool seen = std::any_of(last_segments_.begin(), last_segments_.end(),
                                  [&](const Segment& s) { return s.id == track.id; });
    track.lost = seen ? 0 : track.lost + 1;
    track.now.seen = seen;
    track.now.pose.background_px = track.background_px;
    if (!seen) {
      const double left = 1.0 - double(track.lost) / (kKeepLost + 1);
      track.now.quality = std::min(track.now.quality, left);
      track.now.visible_fraction = std::min(track.now.visible_fraction, left);
    }
    if (track.lost <= kKeepLost && out.size() < kMaxObjects) out.push_back(track.now);
  }
  std::erase_if(tracks_, [](const Track& track) { return track.lost > kKeepLost; });
  last_ = view;
  last_.color = view.color.clone();
  last_.mask = view.mask.clone();
  last_time_s_ = time_s;
  return out;
}

}  // namespace hapticast::server
