// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_run.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/tracker.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kSeenEnough = 0.25;  // share of the object: with less a frame is no measure
constexpr double kBeside_px = 2.0;    // a mask's rim may be off by this before it is foreign
constexpr double kMoves_mm_s = 3.0;   // nominal, rms: with less it rests
constexpr double kLostBelow = 0.1;    // IoU

// Plays what was drawn.
class RecordingSource final : public server::RgbdSource {
 public:
  explicit RecordingSource(const Recording& recording) : recording_(recording) {}

  [[nodiscard]] const server::SourceInfo& info() const override { return recording_.info; }
  std::optional<server::RgbdFrame> read() override {
    if (next_ >= recording_.frames.size()) return std::nullopt;
    server::RgbdFrame frame = recording_.frames[next_++];
    frame.epoch = epoch_;
    return frame;
  }
  bool skip() override { return next_ < recording_.frames.size() && ++next_ > 0; }
  void rewind() override {
    next_ = 0;
    ++epoch_;
  }

 private:
  const Recording& recording_;
  std::size_t next_ = 0;
  std::uint32_t epoch_ = 0;
};

server::VisionSettings settingsOf(const Clicks& clicks) {
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points_px = clicks.on;
  settings.not_points_px = clicks.off;
  return settings;
}

void take(const HapticFrame& frame, const cv::Size& size, Run& run) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  cv::Mat heights(size, CV_32FC1, cv::Scalar(NAN));
  std::optional<Motion> motion;
  std::size_t largest = 0;
  for (const HapticObject& object : frame.objects) {
    const Relief& relief = *object.relief;
    std::size_t area = 0;
    for (int v = 0; v < relief.rect.height; ++v) {
      for (int u = 0; u < relief.rect.width; ++u) {
        const auto at = static_cast<std::size_t>(v) * static_cast<std::size_t>(relief.rect.width) +
                        static_cast<std::size_t>(u);
        if (relief.mask[at] == 0) continue;
        ++area;
        mask.at<uchar>(relief.rect.v + v, relief.rect.u + u) = 255;
        heights.at<float>(relief.rect.v + v, relief.rect.u + u) = relief.height_mm[at];
      }
    }
    if (area <= largest) continue;
    largest = area;
    motion = object.motion;
  }
  run.masks.push_back(largest > 0 ? mask : cv::Mat());
  run.heights.push_back(heights);
  run.motion.push_back(motion);
}

// Velocity of the object's middle in the picture, nominal mm/s.
Vec2 trueVelocity(const Recording& recording, const MotionState& centre) {
  const Vec3& p = centre.pose.at_mm;
  const Vec3& v = centre.velocity_mm_s;
  const double focal_px = recording.camera.fx_px;
  Workspace workspace;
  workspace.width_px = recording.info.width_px;
  workspace.height_px = recording.info.height_px;
  const Vec2 mm = workspace.mmPerPixel();
  const double z2 = p.z() * p.z();
  return {mm.x() * focal_px * (v.x() * p.z() - p.x() * v.z()) / z2,
          -mm.y() * focal_px * (v.y() * p.z() - p.y() * v.z()) / z2};
}

double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return double(values[static_cast<std::size_t>(at)]);
}

void scoreMasks(const Recording& recording, const Run& run, Scores& out) {
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    const Truth& truth = recording.truth[i];
    if (truth.visibleShare() < kSeenEnough) continue;
    const cv::Mat own = truth.mask();
    ++out.frames;
    const double iou = run.masks[i].empty() ? 0.0 : overlapOf(run.masks[i], own);
    out.mean_iou += iou;
    out.worst_iou = std::min(out.worst_iou, iou);
    if (iou < kLostBelow) ++out.lost;
    if (run.masks[i].empty()) continue;
    cv::Mat distance;
    cv::distanceTransform(own == 0, distance, cv::DIST_L2, 5);
    const double foreign =
        cv::countNonZero(run.masks[i] & (distance > kBeside_px)) / double(cv::countNonZero(own));
    out.foreign += foreign;
    out.worst_foreign = std::max(out.worst_foreign, foreign);
  }
  out.mean_iou /= std::max(1.0, double(out.frames));
  out.foreign /= std::max(1.0, double(out.frames));
}

// The part of the announced heights between which the object's own pixels lie, over the clip.
double reliefShare(const Recording& recording, const Run& run) {
  std::vector<float> own;
  for (std::size_t i = 0; i < run.heights.size(); i += 2) {
    const cv::Mat mask = recording.truth[i].mask();
    for (int v = 0; v < mask.rows; v += 2) {
      for (int u = 0; u < mask.cols; u += 2) {
        const float height = run.heights[i].at<float>(v, u);
        if (mask.at<uchar>(v, u) != 0 && !std::isnan(height)) own.push_back(height);
      }
    }
  }
  return (quantile(own, 0.99) - quantile(own, 0.01)) / Workspace().depth_mm;
}

double velocityError(const Recording& recording, const Run& run) {
  double errors = 0.0;
  double speeds = 0.0;
  for (std::size_t i = 0; i < run.motion.size(); ++i) {
    if (recording.truth[i].visibleShare() < kSeenEnough) continue;
    const Vec2 exact = trueVelocity(recording, recording.truth[i].centre);
    const Vec2 got = run.motion[i] ? Vec2(run.motion[i]->velocity_mm_s.head<2>()) : Vec2::Zero();
    errors += (got - exact).squaredNorm();
    speeds += exact.squaredNorm();
  }
  const double frames = std::max(1.0, double(run.motion.size()));
  return std::sqrt(speeds / frames) < kMoves_mm_s ? -1.0 : std::sqrt(errors / speeds);
}

}  // namespace

Recording record(const Scene& scene, const cv::Size& size, std::size_t most_frames) {
  const Film film(scene, size);
  Recording out;
  out.name = scene.name;
  out.info = film.info();
  out.camera = film.camera();
  out.held_at_start = scene.held_at_start;
  const std::size_t count = std::min<std::size_t>(most_frames, *out.info.frame_count);
  out.info.frame_count = count;
  for (std::size_t i = 0; i < count; ++i) {
    Film::Shot shot = film.shoot(i);
    out.frames.push_back(std::move(shot.frame));
    out.truth.push_back(std::move(shot.truth));
  }
  return out;
}

Run watch(const Recording& recording, const Clicks& clicks) {
  Run run;
  const cv::Size size(recording.info.width_px, recording.info.height_px);
  try {
    server::Vision vision(recording.info, settingsOf(clicks));
    RecordingSource source(recording);
    vision.scan(source, nullptr);
    while (const auto frame = source.read()) {
      const double start_us = threadTime_us();
      const auto result = vision.push(*frame, mediaTime(frame->clip_time_s));
      run.ms.push_back(1e-3 * (threadTime_us() - start_us));
      if (result) take(result->frame, size, run);
    }
    for (const server::VisionResult& result : vision.flush()) take(result.frame, size, run);
  } catch (const server::SourceError& error) {
    run = {};
    run.refused = error.what();
    run.masks.resize(recording.frames.size());
    run.motion.resize(recording.frames.size());
  }
  return run;
}

std::optional<cv::Mat> startOf(const Recording& recording, const Clicks& clicks) {
  const cv::Size size(recording.info.width_px, recording.info.height_px);
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  std::uint32_t next_id = 1;
  server::RememberedStart start;
  try {
    server::Tracker tracker(recording.info, settingsOf(clicks), nullptr, next_id, start);
    for (const server::TrackedObject& object : tracker.next(recording.frames.front(), 0.0)) {
      if (object.seen)
        cv::bitwise_or(mask(object.surface.box), object.surface.mask, mask(object.surface.box));
    }
  } catch (const server::SourceError&) {
    return std::nullopt;
  }
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  return mask;
}

Scores scoresOf(const Recording& recording, const Run& run) {
  Scores out;
  scoreMasks(recording, run, out);
  if (!run.refused.empty()) return out;
  out.relief_share = reliefShare(recording, run);
  out.velocity_error = velocityError(recording, run);
  std::vector<double> ms(run.ms.begin() + std::min<std::ptrdiff_t>(1, std::ssize(run.ms)),
                         run.ms.end());
  std::sort(ms.begin(), ms.end());
  if (!ms.empty()) {
    out.median_ms = ms[ms.size() / 2];
    out.slow_ms = ms[ms.size() * 95 / 100];
  }
  return out;
}

double overlapOf(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a & b) / std::max(1.0, double(cv::countNonZero(a | b)));
}

std::optional<Vec2> innermost(const cv::Mat& region) {
  if (cv::countNonZero(region) == 0) return std::nullopt;
  // The picture's border is an edge, too.
  cv::Mat framed;
  cv::copyMakeBorder(region, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(framed, distance, cv::DIST_L2, 5);
  cv::Point at;
  cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &at);
  return Vec2(at.x - 0.5, at.y - 0.5);
}

}  // namespace hapticast::evaluate::held
