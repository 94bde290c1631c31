// SPDX-License-Identifier: MIT
#include "server/source/live/paired_camera.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/source/live/live_source.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/skipped_frames.hpp"

namespace hapticast::server {

namespace {

constexpr Duration kCameraStart = std::chrono::seconds(5);  // chosen: cameras start in 1 to 3 s
constexpr Duration kLongestWait = std::chrono::milliseconds(50);  // chosen: when a stop is noticed
// Chosen: an older time stamp is of another clock, and the arrival counts in its place.
constexpr Duration kOldestStamp = std::chrono::milliseconds(500);

/// What outlives a loss of the camera: its log does not begin anew.
struct CameraLog {
  SkippedFrames skipped{true};
  std::uint64_t next = 0;  // number of the next frame
  bool logged_scaling = false;
};

/// An open camera whose pictures become frames.
class PairedCamera final : public LiveDevice {
 public:
  PairedCamera(std::unique_ptr<PictureCamera> camera, CameraLog& log, const LiveWatch& watch)
      : camera_(std::move(camera)),
        log_(log),
        pairer_(camera_->info().fps),
        deadline_(clock_.now() + kCameraStart) {
    while (!watch.must_stop() && !read()) {
    }
  }

  [[nodiscard]] const SourceInfo& info() const override { return camera_->info(); }
  [[nodiscard]] std::vector<std::string> warnings() const override { return camera_->warnings(); }

  std::optional<LiveFrame> read() override {
    if (clock_.now() >= deadline_) throwNoPair();
    std::optional<LivePicture> picture = camera_->read(kLongestWait);
    if (!picture) return std::nullopt;
    (picture->is_depth ? any_depth_ : any_color_) = true;
    if (!picture->problem.empty()) {
      problem_ = picture->problem;
      log_.skipped.add(log_.next, problem_);
      log_.skipped.endRun();
      return std::nullopt;
    }
    if (!camera_->hasDepth()) return makeFrame({picture->image, {}, picture->time});
    auto pair = pairer_.push(std::move(*picture));
    return pair ? std::optional(makeFrame(std::move(*pair))) : std::nullopt;
  }

 private:
  [[noreturn]] void throwNoPair() const {
    if (!problem_.empty()) throw SourceError(problem_);
    const char* what = camera_->hasDepth() ? "colour and depth of one moment" : "pictures";
    if (!any_color_) what = any_depth_ ? "colour pictures" : "pictures";
    if (any_color_ && !any_depth_ && camera_->hasDepth()) what = "depth pictures";
    throw SourceError(info().name + ": delivers no " + what + "; plug it in again");
  }

  LiveFrame makeFrame(LivePair pair) {
    const LocalTime now = clock_.now();
    deadline_ = now + kGap;
    any_color_ = any_depth_ = false;
    problem_.clear();
    ++log_.next;
    const bool scales = camera_->hasDepth() && pair.depth.size() != pair.color.size();
    if (scales && !std::exchange(log_.logged_scaling, true))
      logScaledDepth(info().name, pair.depth.size(), pair.color.size());
    cv::Mat depth =
        scales ? scaleDepth(pair.depth, info().depth_kind, pair.color) : std::move(pair.depth);
    const bool is_likely = pair.time <= now && now - pair.time <= kOldestStamp;
    return {std::move(pair.color), std::move(depth), is_likely ? pair.time : now};
  }

  const SteadyClock clock_;
  std::unique_ptr<PictureCamera> camera_;
  CameraLog& log_;
  PicturePairer pairer_;
  LocalTime deadline_;      // of the next pair
  bool any_color_ = false;  // since the last pair
  bool any_depth_ = false;
  std::string problem_;  // of a picture since the last pair
};

}  // namespace

PicturePairer::PicturePairer(double fps) : longest_apart_(fromSeconds(0.5 / fps)) {}

std::optional<LivePair> PicturePairer::push(LivePicture picture) {
  (picture.is_depth ? depth_ : color_) = std::move(picture);
  if (!color_ || !depth_ || std::chrono::abs(color_->time - depth_->time) > longest_apart_)
    return std::nullopt;
  LivePair pair{color_->image, depth_->image, color_->time};
  color_.reset();
  depth_.reset();
  return pair;
}

std::unique_ptr<RgbdSource> openPairedCamera(std::function<std::unique_ptr<PictureCamera>()> open) {
  return std::make_unique<LiveSource>(
      [open = std::move(open), log = std::make_shared<CameraLog>()](const LiveWatch& watch) {
        return std::make_unique<PairedCamera>(open(), *log, watch);
      });
}

}  // namespace hapticast::server
