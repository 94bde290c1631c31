// SPDX-License-Identifier: MIT
#include "server/vision/vision.hpp"

#include <algorithm>
#include <deque>
#include <future>
#include <map>
#include <opencv2/core/utility.hpp>
#include <sstream>
#include <thread>
#include <utility>

#include "common/text.hpp"
#include "server/source/scale/picture_scale.hpp"
#include "server/vision/frame_describer.hpp"
#include "server/vision/tracker.hpp"

namespace hapticast::server {

namespace {

// Chosen, frames: of a longer clip only the beginning is scanned, which lasts some seconds.
constexpr std::uint64_t kLongestScan = 600;
// Chosen: margin on either side, as a share of the objects' depth span.
constexpr double kClipMargin = 0.05;
constexpr double kLiveMargin = 0.5;  // chosen: later frames reach farther than the first

/// Returns the name of the scene's object with this number; empty if there is none.
std::string findName(const VisionSettings& settings, int number) {
  const bool named = number >= 1 && std::size_t(number) <= settings.objects.size();
  return named ? settings.objects[std::size_t(number) - 1].name : "";
}

void checkPoints(const SourceInfo& info, const VisionSettings& settings,
                 const std::vector<AuthorPoint>& points, const char* flag) {
  const cv::Size own = ownSize(info);
  for (const AuthorPoint& each : points) {
    const Vec2 point = each.at_px.cwiseProduct(info.own_px);  // as the author wrote it
    const bool inside =
        point.x() >= 0 && point.y() >= 0 && point.x() < own.width && point.y() < own.height;
    if (inside) continue;
    std::ostringstream what;
    const std::string name = findName(settings, each.number);
    if (!name.empty()) {
      what << "--scene " << settings.scene_file << ": object " << quote(name) << ", point ";
    } else {
      what << flag << ' ';
    }
    what << point.x() << ',' << point.y();
    if (each.time_s > 0.0) what << '@' << each.time_s;
    what << ": outside the picture, which is " << own.width << 'x' << own.height
         << "; use u,v in pixels from its top-left corner";
    throw SourceError(what.str());
  }
}

double lastTime_s(const std::vector<AuthorPoint>& points) {
  double last_s = 0.0;
  for (const AuthorPoint& point : points) last_s = std::max(last_s, point.time_s);
  return last_s;
}

// Returns the stated mapped range, if any. --depth-range is the mapped range of metric depth. Of
// 8-bit depth and of relative depth it states the depth of the levels; the thesis's method uses
// them as heights.
std::optional<DepthRange> findGivenRange(const SourceInfo& info, const VisionSettings& settings) {
  if (settings.map_range) return settings.map_range;
  const bool levels = info.depth_kind == DepthKind::kHeight;
  const bool relative =
      info.estimated == EstimatedDepth::kRelative || info.estimated == EstimatedDepth::kInverse;
  if (levels && settings.method == Method::kThesis)
    return settings.depth_range.value_or(info.depth_range.value_or(kHeightRange));
  if (!settings.depth_range) return info.depth_range;
  return levels || relative ? std::nullopt : settings.depth_range;
}

// Chosen: 640x480 takes less than a frame's time on one processor, and stays as fast as it is.
constexpr int kOneThread_px = 640 * 480;

bool usesTwoThreads(const SourceInfo& info, const VisionSettings& settings) {
  if (settings.threads != 0) return settings.threads > 1;
  return !settings.low_latency && info.width_px * info.height_px > kOneThread_px &&
         std::thread::hardware_concurrency() > 1;
}

}  // namespace

void stopOpenCvThreads() { cv::setNumThreads(1); }

class Vision::Impl {
 public:
  Impl(const SourceInfo& info, VisionSettings settings, const Clock* clock)
      : info_(info),
        settings_(std::move(settings)),
        clock_(clock),
        two_threads_(usesTwoThreads(info_, settings_)),
        lookahead_(settings_.low_latency ? 1 : lookaheadFrames(info.fps)),
        describer_(info_, settings_, lookahead_, clock) {
    checkPoints(info_, settings_, settings_.object_points, "--object");
    checkPoints(info_, settings_, settings_.not_points, "--not");
    description_.name = info_.name;
    description_.fps = info_.fps;
    description_.workspace.width_px = info_.width_px;
    description_.workspace.height_px = info_.height_px;
    description_.workspace.stretch = settings_.stretch || settings_.method == Method::kThesis;
    description_.method = settings_.method;
    description_.pipeline_latency = fromSeconds((lookahead_ + (two_threads_ ? 1 : 0)) / info_.fps);
    description_.mass_kg = settings_.mass_kg;
    if (const auto given = findGivenRange(info_, settings_)) mapped_ = MappedRange{*given};
    if (settings_.depth_range) info_.depth_range = settings_.depth_range;
  }

  bool scan(RgbdSource& source, const Progress& progress) {
    const bool nothing_to_find =
        mapped_ && !settings_.moves() && !info_.key_masks && lastAnnotation_s() == 0.0;
    if (info_.live || nothing_to_find) return true;
    // The second pass has the author's non-objects from its first frame on.
    const int passes = lastTime_s(settings_.not_points) > 0.0 ? 2 : 1;
    for (int pass = 0; pass < passes; ++pass) {
      annotations_.start = nullptr;
      annotations_.masks.clear();
      annotations_.open = true;
      const bool whole = browseOnce(source, pass, passes, progress);
      annotations_.open = false;
      if (!whole) return false;
    }
    return true;
  }

  std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time) {
    track(frame, toSeconds(media_time));  // while the last frame is described
    collect();
    if (tracker_->sceneCut()) startEpoch();
    if (!mapped_ && !tracked_.empty()) findLiveRange(tracked_);
    tracker_->decideStages(tracked_);
    for (const TrackedObject& object : tracked_) numbers_[object.id] = object.number;
    VisionResult result;
    result.frame.epoch = epoch_;
    result.frame.id = next_frame_id_++;
    result.frame.media_time = media_time;
    result.color = frame.color;
    describe(std::move(result), frame.index);
    return onReady();
  }

  void setMaterials(const VisionSettings& from) {
    collect();
    settings_.material = from.material;
    settings_.mass_kg = from.mass_kg;
    settings_.objects = from.objects;
    description_.mass_kg = from.mass_kg;
    describer_.motion().setMass(from.mass_kg);
  }

  std::vector<VisionResult> flush() {
    completeAll();
    std::vector<VisionResult> out;
    while (!ready_.empty()) out.push_back(*onReady());
    return out;
  }

  [[nodiscard]] const StreamDescription& description() const { return description_; }
  [[nodiscard]] const std::optional<MappedRange>& mapped() const { return mapped_; }
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const {
    return tracker_ ? tracker_->plans() : std::map<std::uint32_t, std::vector<PlanLine>>();
  }

  void beginAnew() { tracker_.reset(); }

  [[nodiscard]] std::string name(std::uint32_t id) const {
    const auto number = numbers_.find(id);
    return number == numbers_.end() ? "" : findName(settings_, number->second);
  }

 private:
  [[nodiscard]] double lastAnnotation_s() const {
    return std::max(lastTime_s(settings_.object_points), lastTime_s(settings_.not_points));
  }

  bool browseOnce(RgbdSource& source, int pass, int passes, const Progress& progress) {
    std::uint32_t ids = 1;
    Tracker tracker(info_, settings_, nullptr, ids, annotations_);
    ClipMotion clip;
    RangeFinder finder;
    const auto with_annotations = static_cast<std::uint64_t>(lastAnnotation_s() * info_.fps) + 2;
    const std::uint64_t longest =
        settings_.offline ? UINT64_MAX : std::max(kLongestScan, with_annotations);
    const std::uint64_t total =
        std::min(longest, info_.frame_count.value_or(std::max(kLongestScan, with_annotations)));
    std::uint64_t done = 0;
    for (; done < longest; ++done) {
      const std::optional<RgbdFrame> frame = source.read();
      if (!frame) break;
      const double time_s = double(done) / info_.fps;
      for (const TrackedObject& object : tracker.next(*frame, time_s)) {
        if (object.seen)
          clip.add(object.id, frame->index, time_s, object.pose, object.isWellTracked());
        if (object.seen) finder.add(object.id, object.surface, tracker.noise());
      }
      const std::uint64_t all = std::max(total, done + 1);
      const auto before = static_cast<std::uint64_t>(pass) * total;
      if (progress && !progress(before + done + 1, static_cast<std::uint64_t>(passes) * all))
        return false;
    }
    source.rewind();
    if (pass == passes - 1) setClip(std::move(clip), finder, done < longest);
    return true;
  }

  // Adopts the results of a clip's scan: range, motion and largest acceleration.
  void setClip(ClipMotion clip, const RangeFinder& finder, bool ended) {
    if (!mapped_) mapped_ = finder.range(kClipMargin);
    if (!mapped_) return;  // no object in the clip
    clip.smooth(nominal(), lookahead_, ended);
    std::vector<double> accelerations = clip.accelerations_mm_s2(lookahead_ / info_.fps);
    description_.largest_acceleration_mm_s2 = largestAcceleration_mm_s2(accelerations);
    if (settings_.method != Method::kThesis) describer_.motion().setClip(std::move(clip));
  }

  // Starts the second half of a frame. The first half of the next frame does not depend on it:
  // collect() adds its reports to the plans. So two threads yield the same frames as one.
  void describe(VisionResult result, std::uint64_t clip_frame) {
    if (!two_threads_) {
      describer_.add(tracked_, tracker_->noise(), nominal(), std::move(result), clip_frame);
      return collect();
    }
    description_task_ =
        std::async(std::launch::async,
                   [this, objects = tracked_, noise = tracker_->noise(), nominal = nominal(),
                    result = std::move(result), clip_frame]() mutable {
                     describer_.add(objects, noise, nominal, std::move(result), clip_frame);
                   });
  }

  // Waits for describe(), and adopts its results.
  void collect() {
    if (description_task_.valid()) description_task_.get();
    for (const auto& [id, report] : describer_.popReports()) {
      if (tracker_) tracker_->report(id, report);
    }
    for (VisionResult& result : describer_.popCompleted()) ready_.push_back(std::move(result));
    if (info_.live)
      description_.largest_acceleration_mm_s2 = describer_.motion().largestAcceleration_mm_s2();
  }

  void completeAll() {
    collect();
    describer_.completeAll(nominal());
    collect();
  }

  [[nodiscard]] NominalFrame nominal() const {
    return {description_.workspace, mapped_ ? mapped_->range : kHeightRange};
  }

  // Finds the objects of the next frame. A looped clip whose objects have not moved at the seam
  // continues without a new epoch.
  void track(const RgbdFrame& frame, double time_s) {
    const bool wraps = tracker_ && frame.epoch != source_epoch_;
    if (wraps && haveSameObjects(tracked_, first_objects_)) {
      std::vector<TrackedObject> now = tracker_->next(frame, time_s);
      if (!tracker_->sceneCut() && isAllAtRest(tracked_, now, nominal(), settings_)) {
        source_epoch_ = frame.epoch;
        tracked_ = std::move(now);
        return;
      }
    }
    const bool begins = !tracker_ || wraps;
    if (begins) restart(frame.epoch);
    tracked_ = tracker_->next(frame, time_s);
    if (begins) first_objects_ = tracked_;
  }

  // Completes pending frames with shortened windows; no window reaches into the new epoch.
  void startEpoch() {
    completeAll();
    describer_.beginEpoch();
    ++epoch_;
  }

  void restart(std::uint32_t source_epoch) {
    startEpoch();
    describer_.motion().beginClip(next_object_id_);
    tracker_ = std::make_unique<Tracker>(info_, settings_, clock_, next_object_id_, annotations_);
    source_epoch_ = source_epoch;
  }

  void findLiveRange(const std::vector<TrackedObject>& objects) {
    RangeFinder finder;
    for (const TrackedObject& object : objects)
      finder.add(object.id, object.surface, tracker_->noise());
    mapped_ = finder.range(kLiveMargin);
  }

  std::optional<VisionResult> onReady() {
    if (ready_.empty()) return std::nullopt;
    VisionResult result = std::move(ready_.front());
    ready_.pop_front();
    return result;
  }

  SourceInfo info_;
  VisionSettings settings_;
  const Clock* clock_;
  bool two_threads_;
  int lookahead_;
  StreamDescription description_;
  std::optional<MappedRange> mapped_;
  std::uint32_t next_object_id_ = 1;
  std::uint64_t next_frame_id_ = 1;
  std::uint32_t epoch_ = 0;
  std::uint32_t source_epoch_ = 0;
  ClipAnnotations annotations_;  // of a looped or scanned clip
  std::unique_ptr<Tracker> tracker_;
  std::vector<TrackedObject> tracked_;        // objects of the last frame
  std::vector<TrackedObject> first_objects_;  // objects of the tracker's first frame
  std::map<std::uint32_t, int> numbers_;      // by object id
  std::deque<VisionResult> ready_;

  FrameDescriber describer_;            // of description_task_ until collect()
  std::future<void> description_task_;  // the last member: its destructor waits
};

Vision::Vision(const SourceInfo& info, VisionSettings settings, const Clock* clock)
    : impl_(std::make_unique<Impl>(info, std::move(settings), clock)) {}
Vision::~Vision() = default;
bool Vision::scan(RgbdSource& source, const Progress& progress) {
  return impl_->scan(source, progress);
}
std::optional<VisionResult> Vision::push(const RgbdFrame& frame, MediaTime media_time) {
  return impl_->push(frame, media_time);
}
void Vision::setMaterials(const VisionSettings& from) { impl_->setMaterials(from); }
std::vector<VisionResult> Vision::flush() { return impl_->flush(); }
std::map<std::uint32_t, std::vector<PlanLine>> Vision::plan() const { return impl_->plan(); }
void Vision::beginAnew() { impl_->beginAnew(); }
std::string Vision::name(std::uint32_t id) const { return impl_->name(id); }
const std::optional<MappedRange>& Vision::mapped() const { return impl_->mapped(); }
const StreamDescription& Vision::description() const { return impl_->description(); }

}  // namespace hapticast::server
