// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/tracker.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/scenes/drawn_source.hpp"

namespace hapticast::evaluate::held {

namespace {

// Plays what was drawn.
class RecordingSource final : public server::test::DrawnSource {
 public:
  RecordingSource(const Recording& recording, bool with_masks,
                  const std::vector<std::size_t>& drawn)
      : recording_(recording), with_masks_(with_masks), drawn_(drawn) {
    info_ = recording.info;
    info_.key_masks = !drawn.empty();
  }

 private:
  server::RgbdFrame draw(std::uint64_t index) override {
    server::RgbdFrame frame = recording_.frames[index];
    const bool drawn = std::find(drawn_.begin(), drawn_.end(), index) != drawn_.end();
    if (with_masks_ || drawn) frame.mask = recording_.truth[index].mask() / 255;
    return frame;
  }

  const Recording& recording_;
  bool with_masks_;
  const std::vector<std::size_t>& drawn_;
};

server::VisionSettings settingsOf(const Words& words, std::uint64_t threads = 1) {
  server::VisionSettings settings;
  settings.threads = threads;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points = words.on;
  settings.not_points = words.off;
  return settings;
}

void take(const HapticFrame& frame, const cv::Size& size, Run& run) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  cv::Mat heights(size, CV_32FC1, cv::Scalar(NAN));
  cv::Mat layers = cv::Mat::zeros(size, CV_8UC1);
  std::optional<HapticObject> most;
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
        layers.at<uchar>(relief.rect.v + v, relief.rect.u + u) =
            static_cast<uchar>(object.layer + 1);
        heights.at<float>(relief.rect.v + v, relief.rect.u + u) = relief.height_mm[at];
      }
    }
    if (area <= largest) continue;
    largest = area;
    most = object;
  }
  run.masks.push_back(largest > 0 ? mask : cv::Mat());
  run.heights.push_back(heights);
  run.layers.push_back(layers);
  run.largest.push_back(most);
  run.objects.push_back(frame.objects);
}

}  // namespace

Recording record(const Scene& scene, const cv::Size& size, std::size_t most_frames) {
  const Film film(scene, size);
  Recording out;
  out.name = scene.name;
  out.info = film.info();
  out.camera = film.camera();
  out.held_at_start = scene.held_at_start;
  out.object = scene.object;
  out.sensing = scene.sensing;
  const std::size_t count = std::min<std::size_t>(most_frames, *out.info.frame_count);
  out.info.frame_count = count;
  for (std::size_t i = 0; i < count; ++i) {
    Film::Shot shot = film.shoot(i);
    out.frames.push_back(std::move(shot.frame));
    out.truth.push_back(std::move(shot.truth));
  }
  return out;
}

namespace {

Run runVisionWith(const Recording& recording, const server::VisionSettings& settings,
                  bool with_masks, const std::vector<std::size_t>& drawn) {
  Run run;
  const cv::Size size(recording.info.width_px, recording.info.height_px);
  try {
    RecordingSource source(recording, with_masks, drawn);
    server::Vision vision(source.info(), settings);
    vision.scan(source, nullptr);
    const auto begin = std::chrono::steady_clock::now();
    while (const auto frame = source.read()) {
      const double start_us = threadTime_us();
      const auto result = vision.push(*frame, mediaTime(frame->clip_time_s));
      run.ms.push_back(1e-3 * (threadTime_us() - start_us));
      if (result) take(result->frame, size, run);
    }
    const std::vector<server::VisionResult> rest = vision.flush();
    const std::chrono::duration<double> wall_s = std::chrono::steady_clock::now() - begin;
    run.frames_s = double(recording.frames.size()) / wall_s.count();
    for (const server::VisionResult& result : rest) take(result.frame, size, run);
    if (vision.mapped()) run.mapped = vision.mapped()->range;
  } catch (const server::SourceError& error) {
    run = {};
    run.refused = error.what();
    run.masks.resize(recording.frames.size());
    run.largest.resize(recording.frames.size());
    run.objects.resize(recording.frames.size());
  }
  return run;
}

}  // namespace

Run runVision(const Recording& recording, const Words& words, std::uint64_t threads) {
  return runVisionWith(recording, settingsOf(words, threads), false, words.drawn);
}

Run runVisionOnTrueMasks(const Recording& recording) {
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kSource;
  return runVisionWith(recording, settings, true, {});
}

cv::Mat collectMask(const std::vector<server::TrackedObject>& objects, const cv::Size& size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const server::TrackedObject& object : objects) {
    if (object.seen)
      cv::bitwise_or(mask(object.surface.box), object.surface.mask, mask(object.surface.box));
  }
  return mask;
}

std::optional<cv::Mat> startOf(const server::RgbdFrame& first, const server::SourceInfo& info,
                               const Words& words) {
  const cv::Size size(info.width_px, info.height_px);
  server::RgbdFrame frame = first;
  frame.index = 0;
  frame.clip_time_s = 0.0;
  cv::Mat mask;
  std::uint32_t next_id = 1;
  server::ClipAnnotations annotations;
  try {
    server::Tracker tracker(info, settingsOf(words), nullptr, next_id, annotations);
    mask = collectMask(tracker.next(frame, 0.0), size);
  } catch (const server::SourceError&) {
    return std::nullopt;
  }
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  return mask;
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
