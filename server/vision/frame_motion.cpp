// SPDX-License-Identifier: MIT
#include "server/vision/frame_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// Returns the way of the object's outermost point, mm.
double moved_mm(const TrackedObject& before, const TrackedObject& now,
                const NominalFrame& nominal) {
  const Sample a = nominal.sample(before.pose, 0.0);
  const Sample b = nominal.sample(now.pose, 0.0);
  const cv::Size size = now.surface.box.size();
  const double radius_mm =
      0.5 * std::hypot(size.width, size.height) * nominal.workspace.mmPerPixel().maxCoeff();
  return (b.position_mm - a.position_mm).norm() + std::abs(b.angle_rad - a.angle_rad) * radius_mm;
}

// Returns the change of force at a fingertip that the change of relief causes, N.
double reliefChange_N(const TrackedObject& before, const TrackedObject& now,
                      const NominalFrame& nominal, const VisionSettings& settings) {
  if (now.atRest()) return 0.0;
  const auto reliefOf = [&](const TrackedObject& object) {
    return makeRelief(object.surface, nominal.range, nominal.workspace, settings.method);
  };
  const auto a = reliefOf(before);
  const auto b = reliefOf(now);
  if (a->rect != b->rect || a->mask != b->mask) return std::numeric_limits<double>::infinity();
  return forceDifference_N(*a, *b, nominal.workspace.mmPerPixel().x(), settings.stiffness_N_mm());
}

}  // namespace

bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const TrackedObject& x, const TrackedObject& y) {
                      return x.id == y.id && x.seen && y.seen;
                    });
}

bool isAllAtRest(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                 const NominalFrame& nominal, const VisionSettings& settings) {
  if (!haveSameObjects(before, now)) return false;
  return std::equal(before.begin(), before.end(), now.begin(),
                    [&](const TrackedObject& a, const TrackedObject& b) {
                      return settings.stiffness_N_mm() * moved_mm(a, b, nominal) +
                                 reliefChange_N(a, b, nominal, settings) <=
                             settings.plan.error_budget_N;
                    });
}

namespace {

constexpr double kHighQuantile = 0.99;       // chosen: one value in a hundred is noise
constexpr std::size_t kLiveFrames = 600;     // chosen: the running bound covers 20 s at 30 fps
constexpr std::size_t kFewestForBound = 30;  // the quantile of fewer values is noise
constexpr std::uint64_t kRestsLost = 10;     // frames; twice Track::kKeepLost
constexpr double kUsualMass_kg = 0.5;        // chosen: an object that one hand lifts easily
constexpr double kFastest_mm_s = 1e4;  // chosen, of a grid's cells: faster cells lost their tracks
constexpr double kHardest_mm_s2 = 1e6;
constexpr double kFade = 0.95;  // chosen: decay of a grid's cost per frame; half a second at 25 fps

// The grid of an object in layers fits none of its layers, and a client would reject the frame.
bool covers(const MotionGrid& grid, const Relief& relief) {
  const auto sane = [](const std::vector<Eigen::Vector3f>& values, double limit) {
    return std::all_of(values.begin(), values.end(), [&](const Eigen::Vector3f& v) {
      return v.allFinite() && double(v.cwiseAbs().maxCoeff()) < limit;
    });
  };
  return grid.columns == gridCells(relief.rect.width) &&
         grid.rows == gridCells(relief.rect.height) && sane(grid.velocity_mm_s, kFastest_mm_s) &&
         sane(grid.acceleration_mm_s2, kHardest_mm_s2);
}

// Clients add grid and rigid motion, so the rigid motion is subtracted from a whole flow.
std::shared_ptr<const MotionGrid> subtractRigid(const MotionGrid& flow, const Motion& motion) {
  auto out = std::make_shared<MotionGrid>(flow);
  for (Eigen::Vector3f& v : out->velocity_mm_s) v -= motion.velocity_mm_s.cast<float>();
  for (Eigen::Vector3f& a : out->acceleration_mm_s2) a -= motion.acceleration_mm_s2.cast<float>();
  return out;
}

}  // namespace

double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2) {
  if (accelerations_mm_s2.empty()) return 0.0;
  return computeQuantile(accelerations_mm_s2, kHighQuantile);
}

FrameMotion::FrameMotion(const SourceInfo& info, const VisionSettings& settings, int lookahead,
                         const Clock* clock)
    : info_(info), settings_(settings), lookahead_(lookahead), clock_(clock) {}

std::map<std::uint32_t, StageReport> FrameMotion::add(std::uint64_t frame_id, double time_s,
                                                      const std::vector<TrackedObject>& objects) {
  std::map<std::uint32_t, StageReport> before = std::exchange(reports_, {});
  std::map<std::uint32_t, CellFlow> cells = std::exchange(cells_, {});
  std::map<std::uint32_t, StageReport> durations;
  for (const TrackedObject& object : objects) {
    const std::uint32_t id = object.id;
    cells_[id] = object.seen ? measureCells(object, cells[id], durations[id]) : cells[id];
    if (object.seen) history_.add(id, {frame_id, time_s, object.pose, cells_[id]});
    reports_[id] = before[id];
  }
  return durations;
}

// The plan omits residuals only; the thesis's method has no plan.
CellFlow FrameMotion::measureCells(const TrackedObject& object, const CellFlow& last,
                                   StageReport& report) const {
  CellInput input = object.cells;
  const bool residual = input.kind == CellInput::Kind::kResidual;
  if (residual && !object.measures_grid) input.kind = CellInput::Kind::kNone;
  const ScopedStageTimer lap(residual ? clock_ : nullptr, report, Stage::kGrid);
  return server::measureCells(input, object.surface, last, settings_.motion);
}

void FrameMotion::forget() {
  history_ = {};
  impacts_.clear();
}

void FrameMotion::complete(HapticFrame& frame, std::uint64_t clip_frame,
                           const NominalFrame& nominal) {
  std::set<std::uint32_t> present;
  const HapticObject* nearer = nullptr;  // layer of the same object
  for (HapticObject& object : frame.objects) {
    present.insert(object.id);
    if (nearer != nullptr && nearer->id == object.id) {
      object.motion = nearer->motion;
      object.impacts = nearer->impacts;
      continue;
    }
    nearer = &object;
    const MotionWindow around = history_.window(object.id, frame.id, lookahead_, nominal);
    Motion motion = history_.motion(object.id, around, lookahead_, nominal);
    motion.quality = object.motion.quality;
    motion.visible_fraction = object.motion.visible_fraction;
    object.motion = motion;
    if (around.at) {
      findImpacts(object, frame, around);
      setFromClip(object, frame.media_time, around.samples[*around.at].position_mm, clip_frame);
    }
    addGrid(object, frame, nominal);
    if (info_.live) boundAcceleration(object);
  }
  std::erase_if(impacts_, [&](const auto& item) { return !present.contains(item.first); });
  const auto reach = static_cast<std::uint64_t>(lookahead_);
  if (frame.id > reach) history_.dropBefore(frame.id - reach, kRestsLost);
}

// An impact between this frame and the next is found in this frame. Impacts around earlier frames
// are repeated for clients that missed them.
void FrameMotion::findImpacts(HapticObject& object, const HapticFrame& frame,
                              const MotionWindow& around) {
  ImpactFinder& finder = impacts_[object.id];
  finder.test(around.samples, *around.at);
  object.impacts = finder.findAround(toSeconds(frame.media_time), reach_s());
}

void FrameMotion::setFromClip(HapticObject& object, MediaTime media_time, const Vec3& measured_mm,
                              std::uint64_t clip_frame) const {
  const std::uint32_t in_clip = object.id - first_object_id_ + 1;
  const ClipMotion::Moment* const known = clip_.at(in_clip, clip_frame, measured_mm);
  if (known == nullptr) return;
  const Motion windowed = object.motion;
  const bool still = windowed.velocity_mm_s.isZero(0.0) && windowed.acceleration_mm_s2.isZero(0.0);
  // The scan may still have measured motion here where the object is now held at rest.
  if (!still) object.motion = known->motion;
  object.motion.reference_point = windowed.reference_point;
  object.motion.quality = windowed.quality;
  object.motion.visible_fraction = windowed.visible_fraction;
  object.impacts = clip_.findImpactsAround(in_clip, known->time_s, reach_s());
  if (object.impacts.size() > kMaxImpacts) object.impacts.resize(kMaxImpacts);
  const Duration clip_began = media_time - mediaTime(known->time_s);
  for (Impact& impact : object.impacts) impact.time += clip_began;
}

void FrameMotion::addGrid(HapticObject& object, const HapticFrame& frame,
                          const NominalFrame& nominal) {
  if (settings_.method != Method::kThesis) {
    addResidual(object, frame, nominal);
  } else if (const auto flow = history_.grid(object.id, frame.id, lookahead_, nominal)) {
    object.grid = subtractRigid(*flow, object.motion);
  }
}

// Adds the motion that the rigid motion does not explain, if it is worth its bytes: on an object of
// the usual mass its force exceeds the error budget. The forces of the frames before count too,
// with decreasing weight, because oscillations pass through zero.
void FrameMotion::addResidual(HapticObject& object, const HapticFrame& frame,
                              const NominalFrame& nominal) {
  // A window across an impact starts before the impact and yields motion that no object has.
  const double window_s = (lookahead_ + 1) / info_.fps;
  const bool smooth = object.impacts.empty() &&
                      impacts_[object.id].findAround(toSeconds(frame.media_time), window_s).empty();
  const auto report = reports_.find(object.id);
  if (!smooth || report == reports_.end()) return;
  if (!history_.hasCells(object.id, frame.id, lookahead_)) return;
  auto grid = history_.grid(object.id, frame.id, lookahead_, nominal);
  if (grid == nullptr) return;
  double square = 0;
  for (const Eigen::Vector3f& a : grid->acceleration_mm_s2) square += double(a.squaredNorm());
  square /= double(std::max<std::size_t>(1, grid->acceleration_mm_s2.size()));
  const double force_change_N =
      object.material.mass_kg.value_or(settings_.mass_kg.value_or(kUsualMass_kg)) * 1e-3 *
      std::sqrt(square);
  constexpr auto kGrid = static_cast<std::size_t>(Stage::kGrid);
  std::optional<double>& cost_N = report->second.costs_N[kGrid];
  cost_N = std::max(force_change_N, kFade * cost_N.value_or(0.0));
  const PlanSettings& plan = settings_.plan;
  const bool worth =
      plan.everything || plan.forced[kGrid].value_or(false) || *cost_N > plan.error_budget_N;
  if (worth && covers(*grid, *object.relief)) object.grid = grid;
}

void FrameMotion::boundAcceleration(const HapticObject& object) {
  if (object.motion.quality < TrackedObject::kGoodQuality || !object.impacts.empty()) return;
  live_accelerations_mm_s2_.push_back(object.motion.acceleration_mm_s2.norm());
  if (live_accelerations_mm_s2_.size() < kFewestForBound) return;
  if (live_accelerations_mm_s2_.size() > kLiveFrames) live_accelerations_mm_s2_.pop_front();
  std::vector<double> recent(live_accelerations_mm_s2_.begin(), live_accelerations_mm_s2_.end());
  largest_mm_s2_ = std::max(largest_mm_s2_, server::largestAcceleration_mm_s2(recent));
}

}  // namespace hapticast::server
