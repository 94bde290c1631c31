// SPDX-License-Identifier: MIT
#include "server/vision/vision.hpp"

#include <algorithm>
#include <deque>
#include <sstream>

#include "common/wire_limits.hpp"
#include "server/vision/describe.hpp"
#include "server/vision/range.hpp"
#include "server/vision/tracker.hpp"

namespace hapticast::server {

namespace {

constexpr std::uint64_t kLongestScan =
    600;  // frames; of a longer clip only its beginning is looked through
constexpr std::size_t kFewestForBound = 30;  // a quantile of less is their noise
constexpr double kUsualMass_kg = 0.5;
constexpr double kFastest_mm_s = 1e4;  // of a grid's cells: beyond, they were lost
constexpr double kHardest_mm_s2 = 1e6;
constexpr double kClipMargin = 0.05;  // of the objects' span in depth, on either side
constexpr double kLiveMargin = 0.5;   // they have more to show than what the first frame holds

void checkPoints(const SourceInfo& info, const std::vector<Vec2>& points, const char* flag) {
  for (const Vec2& point : points) {
    const bool inside =
        point.x() >= 0 && point.y() >= 0 && point.x() < info.width_px && point.y() < info.height_px;
    if (inside) continue;
    std::ostringstream what;
    what << flag << ' ' << point.x() << ',' << point.y() << ": outside the picture, which is "
         << info.width_px << 'x' << info.height_px
         << "; give u,v in pixels from its top-left corner";
    throw SourceError(what.str());
  }
}

// Whether a frame with one more object is still one that a client takes.
bool hasRoomFor(const HapticObject& object, const HapticFrame& frame) {
  const auto pixels = [](const HapticObject& o) {
    return static_cast<std::size_t>(o.relief->rect.width) *
           static_cast<std::size_t>(o.relief->rect.height);
  };
  std::size_t sum = pixels(object);
  for (const HapticObject& other : frame.objects) sum += pixels(other);
  return frame.objects.size() < kMaxObjects && sum <= limits::kReliefPixels;
}

// Forgets what is kept for objects (by id) that are not there any more.
template <class Kept>
void eraseGone(std::map<std::uint32_t, Kept>& kept, const std::vector<HapticObject>& objects) {
  std::erase_if(kept, [&](const auto& item) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const HapticObject& o) { return o.id == item.first; });
  });
}

// Of an object in layers it is no layer's; a viewer would refuse it.
bool covers(const MotionGrid& grid, const Relief& relief) {
  const auto cells = [](int px) { return (px + kGridCell_px - 1) / kGridCell_px; };
  const auto sane = [](const std::vector<Eigen::Vector3f>& values, double limit) {
    return std::all_of(values.begin(), values.end(), [&](const Eigen::Vector3f& v) {
      return v.allFinite() && double(v.cwiseAbs().maxCoeff()) < limit;
    });
  };
  return grid.columns == cells(relief.rect.width) && grid.rows == cells(relief.rect.height) &&
         sane(grid.velocity_mm_s, kFastest_mm_s) && sane(grid.acceleration_mm_s2, kHardest_mm_s2);
}

}  // namespace

class Vision::Impl {
 public:
  Impl(const SourceInfo& info, VisionSettings settings)
      : info_(info),
        settings_(std::move(settings)),
        lookahead_(settings_.low_latency ? 1 : lookaheadFrames(info.fps)) {
    checkPoints(info_, settings_.object_points_px, "--object");
    checkPoints(info_, settings_.not_points_px, "--not");
    description_.name = info_.name;
    description_.fps = info_.fps;
    description_.workspace.width_px = info_.width_px;
    description_.workspace.height_px = info_.height_px;
    description_.workspace.stretch = settings_.stretch || settings_.method == Method::kThesis;
    description_.method = settings_.method;
    description_.pipeline_latency = fromSeconds(lookahead_ / info_.fps);
    description_.mass_kg = settings_.mass_kg;
    range_ = settings_.depth_range ? settings_.depth_range : info_.depth_range;
    if (info_.depth_kind == DepthKind::kHeight) {
      if (!range_) range_ = kHeightRange;
      info_.depth_range = range_;
    }
  }

  void scan(RgbdSource& source, const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
    if (info_.live) return;
    std::uint32_t ids = 1;
    Tracker tracker(info_, settings_, ids, start_);
    MotionHistory history;
    RangeFinder finder;
    const std::uint64_t total = std::min(kLongestScan, info_.frame_count.value_or(kLongestScan));
    std::uint64_t done = 0;
    for (; done < kLongestScan; ++done) {
      const std::optional<RgbdFrame> frame = source.read();
      if (!frame) break;
      const double time_s = double(done) / info_.fps;
      const std::vector<TrackedObject> objects = tracker.next(*frame, time_s);
      history.add(done, time_s, objects);
      for (const TrackedObject& object : objects) finder.add(object.surface, tracker.noise());
      if (progress) progress(done + 1, std::max(total, done + 1));
    }
    source.rewind();
    if (!range_) range_ = finder.range(kClipMargin);
    if (!range_) return;  // no object in the clip
    std::vector<double> accelerations = history.accelerations_mm_s2(lookahead_, nominal());
    description_.largest_acceleration_mm_s2 = largestAcceleration_mm_s2(accelerations);
  }

  std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time) {
    if (!tracker_ || frame.epoch != source_epoch_) restart(frame.epoch);
    const double time_s = toSeconds(media_time);
    std::vector<TrackedObject> objects = tracker_->next(frame, time_s);
    if (tracker_->sceneCut()) startEpoch();
    if (!range_ && !objects.empty()) findLiveRange(objects);
    const std::uint64_t id = next_frame_id_++;
    VisionResult result;
    result.frame.epoch = epoch_;
    result.frame.id = id;
    result.frame.media_time = media_time;
    result.color = frame.color.clone();  // the source may use its buffer again
    for (const TrackedObject& object : objects) {
      for (HapticObject& layer : describeLayers(object, id, last_objects_, tracker_->noise(),
                                                nominal(), settings_, cutters_[object.id])) {
        if (hasRoomFor(layer, result.frame)) result.frame.objects.push_back(std::move(layer));
      }
    }
    last_objects_ = result.frame.objects;
    eraseGone(cutters_, last_objects_);
    history_.add(id, time_s, objects);
    for (const TrackedObject& object : objects) object_plans_[object.id] = object.plan;
    eraseGone(object_plans_, last_objects_);
    pending_.push_back(std::move(result));
    if (pending_.size() > static_cast<std::size_t>(lookahead_)) complete();
    return takeReady();
  }

  std::vector<VisionResult> flush() {
    while (!pending_.empty()) complete();
    std::vector<VisionResult> out;
    while (!ready_.empty()) out.push_back(*takeReady());
    return out;
  }

  [[nodiscard]] const StreamDescription& description() const { return description_; }
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const {
    std::map<std::uint32_t, std::vector<PlanLine>> out;
    for (const auto& [id, plan] : object_plans_) out[id] = plan->lines();
    return out;
  }

 private:
  [[nodiscard]] NominalFrame nominal() const {
    return {description_.workspace, range_.value_or(kHeightRange)};
  }

  // What is inside is completed with shortened windows; nothing of it reaches into the new epoch.
  void startEpoch() {
    while (!pending_.empty()) complete();
    history_ = {};
    impacts_.clear();
    cutters_.clear();
    last_objects_.clear();
    ++epoch_;
  }

  void restart(std::uint32_t source_epoch) {
    startEpoch();
    tracker_ = std::make_unique<Tracker>(info_, settings_, next_object_id_, start_);
    source_epoch_ = source_epoch;
  }

  void findLiveRange(const std::vector<TrackedObject>& objects) {
    RangeFinder finder;
    for (const TrackedObject& object : objects) finder.add(object.surface, tracker_->noise());
    range_ = finder.range(kLiveMargin);
  }

  // The oldest pending frame gets its motion from the window around it.
  void complete() {
    VisionResult result = std::move(pending_.front());
    pending_.pop_front();
    const std::uint64_t id = result.frame.id;
    const HapticObject* nearer = nullptr;  // layer of the same object
    for (HapticObject& object : result.frame.objects) {
      if (nearer != nullptr && nearer->id == object.id) {
        object.motion = nearer->motion;
        object.impacts = nearer->impacts;
        continue;
      }
      nearer = &object;
      Motion motion = history_.motion(object.id, id, lookahead_, nominal());
      motion.quality = object.motion.quality;
      motion.visible_fraction = object.motion.visible_fraction;
      object.motion = motion;
      findImpacts(object, result.frame);
      if (settings_.method == Method::kThesis)
        object.grid = history_.grid(object.id, id, lookahead_, nominal());
      else
        addResidual(object, result.frame);
      if (info_.live) boundAcceleration(object);
    }
    eraseGone(impacts_, result.frame.objects);
    const auto reach = static_cast<std::uint64_t>(lookahead_);
    if (id > reach) history_.dropBefore(id - reach);
    ready_.push_back(std::move(result));
  }

  // What the rigid motion does not explain, where it is worth its bytes: felt by an object of the
  // usual mass it is more than the error budget.
  void addResidual(HapticObject& object, const HapticFrame& frame) {
    // A window across an impact, its first cells from the frame before it, shows what nothing has.
    const double reach_s = (lookahead_ + 1) / info_.fps;
    const bool smooth = impacts_[object.id].around(toSeconds(frame.media_time), reach_s).empty();
    const auto plan = object_plans_.find(object.id);
    if (!smooth || plan == object_plans_.end()) return;
    if (!history_.hasCells(object.id, frame.id, lookahead_)) return;
    auto grid = history_.grid(object.id, frame.id, lookahead_, nominal());
    if (grid == nullptr) return;
    double square = 0;
    for (const Eigen::Vector3f& a : grid->acceleration_mm_s2) square += double(a.squaredNorm());
    square /= double(std::max<std::size_t>(1, grid->acceleration_mm_s2.size()));
    const double felt_N = settings_.mass_kg.value_or(kUsualMass_kg) * 1e-3 * std::sqrt(square);
    if (plan->second->residual(felt_N) && covers(*grid, *object.relief)) object.grid = grid;
  }

  // An impact between this frame and the next is known now; those of the frames before are repeated
  // for a viewer who has missed them.
  void findImpacts(HapticObject& object, const HapticFrame& frame) {
    const auto around = history_.window(object.id, frame.id, lookahead_, nominal());
    if (!around.at) return;
    ImpactFinder& finder = impacts_[object.id];
    finder.look(around.samples, *around.at);
    object.impacts = finder.around(toSeconds(frame.media_time), lookahead_ / info_.fps);
  }

  // Of a live source: never falls.
  void boundAcceleration(const HapticObject& object) {
    if (object.motion.quality < kGoodQuality || !object.impacts.empty()) return;
    live_accelerations_mm_s2_.push_back(object.motion.acceleration_mm_s2.norm());
    if (live_accelerations_mm_s2_.size() < kFewestForBound) return;  // stays unknown
    if (live_accelerations_mm_s2_.size() > kLongestScan) live_accelerations_mm_s2_.pop_front();
    std::vector<double> recent(live_accelerations_mm_s2_.begin(), live_accelerations_mm_s2_.end());
    double& largest = description_.largest_acceleration_mm_s2;
    largest = std::max(largest, largestAcceleration_mm_s2(recent));
  }

  std::optional<VisionResult> takeReady() {
    if (ready_.empty()) return std::nullopt;
    VisionResult result = std::move(ready_.front());
    ready_.pop_front();
    return result;
  }

  SourceInfo info_;
  VisionSettings settings_;
  int lookahead_;
  StreamDescription description_;
  std::optional<DepthRange> range_;
  std::uint32_t next_object_id_ = 1;
  std::uint64_t next_frame_id_ = 1;
  std::uint32_t epoch_ = 0;
  std::uint32_t source_epoch_ = 0;
  RememberedStart start_;  // a clip that is looped, or was scanned, starts as it did
  std::unique_ptr<Tracker> tracker_;
  MotionHistory history_;
  std::map<std::uint32_t, ImpactFinder> impacts_;  // by object id
  std::map<std::uint32_t, LayerCutter> cutters_;
  std::deque<double> live_accelerations_mm_s2_;
  std::vector<HapticObject> last_objects_;
  std::map<std::uint32_t, std::shared_ptr<ScenePlan>> object_plans_;
  std::deque<VisionResult> pending_;
  std::deque<VisionResult> ready_;
};

Vision::Vision(const SourceInfo& info, VisionSettings settings)
    : impl_(std::make_unique<Impl>(info, std::move(settings))) {}
Vision::~Vision() = default;
void Vision::scan(RgbdSource& source,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  impl_->scan(source, progress);
}
std::optional<VisionResult> Vision::push(const RgbdFrame& frame, MediaTime media_time) {
  return impl_->push(frame, media_time);
}
std::vector<VisionResult> Vision::flush() { return impl_->flush(); }
std::map<std::uint32_t, std::vector<PlanLine>> Vision::plan() const { return impl_->plan(); }
const StreamDescription& Vision::description() const { return impl_->description(); }

}  // namespace hapticast::server
