// SPDX-License-Identifier: MIT
#include "server/vision/track.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

// A depth camera slower than the colour camera repeats its depth: nearly all of it, to the bit.
constexpr double kRepeated = 0.98;  // chosen
// Chosen: with more motion in colour, unchanged depth is a repeat and not rest.
constexpr double kMoves_px = 0.3;
constexpr double kChanges = 1.2;         // grey levels a pixel
constexpr double kTooLittle = 0.25;      // measured: a smaller visible share yields no motion
constexpr double kBlindQuality = 0.5;    // chosen, upper limit: tracked without depth
constexpr double kGuessQuality = 0.8;    // chosen: followed without a reliable flow
constexpr double kFullAreaShare = 0.05;  // chosen: accepts a new size within a second

ScenePlan startPlan(const TrackSettings& settings) {
  PlanSettings plan = settings.vision.plan;
  if (settings.vision.motion == MotionMode::kNone) plan.forced[std::size_t(Stage::kMotion)] = false;
  return {plan, settings.exact_masks};
}

std::string_view toText(Cause cause) {
  switch (cause) {
    case Cause::kNone:
    case Cause::kNew:
      break;
    case Cause::kColor:
      return "its colours change";
    case Cause::kOutline:
      return "its outline changes";
    case Cause::kDepth:
      return "its depth changes in places";
    case Cause::kAllDepth:
      return "it moves in depth";
  }
  return {};
}

cv::Point2d findMiddle(const cv::Mat& mask) {
  const cv::Rect box = findBoxAround(mask, 0);
  return computeCentroid(cv::moments(mask(box), true), box.tl());
}

}  // namespace

Track::Track(const TrackSettings& settings, const Segment& segment, const FramePair& frames)
    : settings_(&settings),
      plan_(startPlan(settings)),
      mask_(segment.mask),
      motion_(settings.pose, frames.now.gray, now_.surface = denoiseSurface(segment, frames)),
      full_area_px_(double(cv::countNonZero(segment.mask))),
      middle_px_(findMiddle(segment.mask)) {
  now_.id = segment.id;
  now_.number = segment.number;
  now_.quality = segment.quality;
  now_.pose = motion_.pose();
  now_.measured = now_.surface;
  hold(frames, false);
}

bool Track::isResting(const FramePair& frames, bool annotated) {
  plan_.nextFrame();
  const bool left_out = !plan_.isOn(Stage::kMotion) && !plan_.isOn(Stage::kSegment) &&
                        settings_->vision.method != Method::kThesis;
  rests_ = !annotated &&
           (frames.identical ||
            (left_out && lost_ == 0 && now_.atRest() &&
             hold_.isUnchanged(frames.now, computeStaticNoise(frames.noise, now_.surface))));
  return rests_;
}

const ObjectFlow& Track::computeFlow(const FramePair& frames) {
  flow_ = {};
  flow_.isStatic = rests_;
  const bool asked = !settings_->exact_masks || settings_->vision.motion != MotionMode::kNone;
  if (rests_ || lost_ > 0 || !asked) return flow_;
  const ScopedStageTimer lap(settings_->clock, report_, Stage::kMotion);
  // One tracker serves mask and motion; if it fails, corners track the mask.
  if (!repeatsDepth(frames, mask_)) {
    if (const auto found = motion_.find(frames.now)) return flow_ = *found;
  }
  return flow_ = trackObject(frames.last.gray, frames.now.gray, mask_, last_step_px_);
}

void Track::update(const Segment& segment, const FramePair& frames) {
  lost_ = 0;
  now_.seen = true;
  now_.measured = {};
  if (rests_) {
    plan_.setResting(true);
    now_.held_share = 1.0;
    now_.cells = {};
    now_.cells.kind = CellInput::Kind::kRest;
    now_.pose.background_px = background_px_;
    return;
  }
  const bool repeats = repeatsDepth(frames, segment.mask);
  const bool blind = !hasDepth(frames.now.depth, segment.mask);
  const bool repeated = blind || repeats;
  const Surface before = now_.surface;
  const Surface seen = repeated ? warpSurface(segment.mask, before, flow_.similarity)
                                : denoiseSurface(segment, frames);
  now_.surface = seen;
  if (!repeated) now_.measured = seen;
  updatePresence(segment, blind);
  hold(frames, repeated);
  plan_.setResting(now_.atRest(), toText(hold_.cause()));
  {
    const ScopedStageTimer lap(settings_->clock, report_, Stage::kMotion);
    // Motion is measured on this frame's surface, not on the surface held from earlier frames.
    now_.pose = motion_.advance({.flow = flow_,
                                 .gray = frames.now.gray,
                                 .surface = seen,
                                 .repeated = repeated,
                                 .at_rest = now_.atRest(),
                                 .visible_fraction = now_.visible_fraction});
  }
  now_.pose.background_px = background_px_;
  now_.cells = cellInput(frames, before);
  const cv::Point2d middle_px = findMiddle(segment.mask);
  last_step_px_ = middle_px - middle_px_;
  middle_px_ = middle_px;
  mask_ = segment.mask;
}

void Track::lose() {
  ++lost_;
  now_.seen = false;
  now_.measured = {};
  now_.pose.background_px = background_px_;
  const double left = 1.0 - double(lost_) / (kKeepLost + 1);
  now_.quality = std::min(now_.quality, left);
  now_.visible_fraction = std::min(now_.visible_fraction, left);
}

void Track::decideStages(TrackedObject& object) const {
  object.smooths = plan_.isOn(Stage::kSmooth);
  object.measures_smooth = plan_.measureNow();
  object.measures_grid = plan_.isOn(Stage::kGrid);
}

bool Track::repeatsDepth(const FramePair& frames, const cv::Mat& mask) const {
  if (settings_->exact_masks || frames.last.depth.empty()) return false;
  const cv::Rect box = findBoxAround(mask, 8);
  const cv::Mat valid = frames.now.depth(box) > 0;
  const cv::Mat same = (frames.now.depth(box) == frames.last.depth(box)) & valid;
  if (cv::countNonZero(same) < kRepeated * cv::countNonZero(valid)) return false;
  const cv::Vec2d shift(flow_.similarity(0, 2), flow_.similarity(1, 2));
  return cv::norm(shift) > kMoves_px ||
         cv::norm(frames.now.gray(box), frames.last.gray(box), cv::NORM_L1) > kChanges * box.area();
}

Surface Track::denoiseSurface(const Segment& segment, const FramePair& frames) {
  const Method method = settings_->vision.method;
  const bool clean = plan_.isOn(Stage::kClean) || method == Method::kThesis;
  const bool measure = plan_.measureNow() && method != Method::kThesis;
  Surface raw;
  if (!clean || measure) {
    raw = rawSurface(frames.now.depth, segment.mask, frames.noise);
    // Holes must be filled.
    if (!clean && !measure && raw.isMeasuredEverywhere()) return raw;
  }
  const ScopedStageTimer lap(settings_->clock, report_, Stage::kClean);
  Surface out =
      cleanSurface(frames.now.depth, segment.mask, frames.noise, method, settings_->exact_masks);
  if (measure) {
    // Own masks may include background in any frame, not just in measured frames.
    const bool same =
        settings_->exact_masks && raw.isMeasuredEverywhere() && out.isMeasuredEverywhere();
    report_.costs_N[std::size_t(Stage::kClean)] =
        same ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return out;
}

// Replaces the resting parts of the new surface by their held depth. Does nothing for exact depth.
void Track::hold(const FramePair& frames, bool repeated) {
  now_.held_share = 0.0;
  if (settings_->vision.method == Method::kThesis) return;
  const StaticNoise noise = computeStaticNoise(frames.noise, now_.surface);
  if (settings_->exact_masks && noise.clean) return;
  now_.surface = hold_.apply(frames.now.gray, now_.surface, noise, repeated);
  now_.held_share = hold_.share();
}

void Track::updatePresence(const Segment& segment, bool blind) {
  const cv::Rect box = now_.surface.box;
  const double area = cv::countNonZero(now_.surface.mask);
  const cv::Size picture = segment.mask.size();
  const bool entire =
      box.x > 0 && box.y > 0 && box.br().x < picture.width && box.br().y < picture.height;
  if (flow_.rotation_reliable) full_area_px_ *= flow_.scale() * flow_.scale();
  // A whole object that remains smaller has shrunk; an object cut by the border has not.
  if (entire) full_area_px_ += kFullAreaShare * (area - full_area_px_);
  full_area_px_ = std::max(full_area_px_, area);
  now_.visible_fraction = area / full_area_px_;
  now_.quality = segment.quality * (flow_.reliable ? 1.0 : kGuessQuality);
  // Too small a visible share yields no motion: its shape is sent without a force of motion.
  if (now_.visible_fraction < kTooLittle) now_.quality = 0.0;
  if (blind) now_.quality = std::min(now_.quality, kBlindQuality);
}

// The thesis's method measures the dense flow, the others the residual of the rigid motion.
CellInput Track::cellInput(const FramePair& frames, const Surface& before) const {
  using Kind = CellInput::Kind;
  CellInput out{Kind::kNone, frames.interval_s, frames.last.gray, frames.now.gray, {}, before};
  if (settings_->vision.method == Method::kThesis) {
    if (settings_->vision.motion == MotionMode::kNone) return out;
    out.kind = Kind::kWhole;
    out.last_mask = mask_;
  } else if (motion_.aligned()) {
    out.kind = Kind::kResidual;
    out.explained = motion_.predictMotion();
  }
  return out;
}

}  // namespace hapticast::server
