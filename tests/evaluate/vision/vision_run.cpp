// SPDX-License-Identifier: MIT
#include "tests/evaluate/vision/vision_run.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "server/vision/motion/pose_tracker.hpp"
#include "server/vision/segment/make_segmenter.hpp"
#include "server/vision/surface/enhance.hpp"
#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate {

using server::FramePair;
using server::ObjectFlow;
using server::PoseTracker;
using server::Segment;
using server::Surface;

namespace {

// Adds the time since the last call to one stage after the other.
class StageClock {
 public:
  void end(double& stage_us) {
    const double now_us = threadTime_us();
    stage_us += now_us - last_us_;
    last_us_ = now_us;
  }
  void begin() { last_us_ = threadTime_us(); }

 private:
  double last_us_ = threadTime_us();
};

// The stages of one object, one after the other, each timed.
class Stages {
 public:
  Stages(const Clip& clip, server::SegmentMode mode, Method method)
      : clip_(clip), frames_(clip.info, false) {
    settings_.method = method;
    settings_.segment = mode;
    settings_.object_points = {{centroidOf_px(clip.truth[0].mask)}};
    segmenter_ = server::makeSegmenter(settings_, true, next_id_);
  }

  // The object's mask in the next frame; empty: none.
  cv::Mat next(const server::RgbdFrame& frame, StageTimes& times) {
    StageClock clock;
    const FramePair frames = frames_.push(frame, frame.clip_time_s);
    clock.end(times.view);
    const server::Flows flows = follow(frames);
    clock.end(times.track);
    const std::vector<Segment> segments = segmenter_->next(frames, flows);
    clock.end(times.segment);
    cv::Mat mask = segments.empty() ? cv::Mat() : segments[0].mask;
    if (segments.empty()) {
      pose_.reset();
    } else {
      touch(segments[0], frames, flows, times);
    }
    return mask;
  }

 private:
  server::Flows follow(const FramePair& frames) {
    server::Flows flows;
    if (!pose_) return flows;
    const std::optional<ObjectFlow> found = pose_->find(frames.now);
    flows[id_] =
        found ? *found : server::trackObject(frames.last.gray, frames.now.gray, mask_, step_px_);
    return flows;
  }

  void touch(const Segment& segment, const FramePair& frames, const server::Flows& flows,
             StageTimes& times) {
    StageClock clock;
    const Surface surface =
        cleanSurface(frames.now.depth, segment.mask, frames.noise, settings_.method);
    clock.end(times.clean);
    makeRelief(surface, *clip_.info.depth_range, {}, settings_.method);
    clock.end(times.relief);
    const Vec2 centre = centroidOf_px(segment.mask);
    if (!pose_ || id_ != segment.id) {
      pose_.emplace(server::PoseSettings{settings_.motion, settings_.method == Method::kHapticast,
                                         false, *clip_.info.camera, frames.now.gray.size()},
                    frames.now.gray, surface);
      step_px_ = {0, 0};
    } else {
      pose_->advance({flows.at(id_), frames.now.gray, surface});
      step_px_ = {centre.x() - centre_.x(), centre.y() - centre_.y()};
    }
    id_ = segment.id;
    mask_ = segment.mask;
    centre_ = centre;
  }

  const Clip& clip_;
  server::VisionSettings settings_;
  std::uint32_t next_id_ = 1;
  std::unique_ptr<server::Segmenter> segmenter_;
  server::FramePairs frames_;
  std::optional<PoseTracker> pose_;
  std::uint32_t id_ = 0;
  cv::Mat mask_;
  Vec2 centre_{0, 0};
  cv::Vec2d step_px_{0, 0};
};

cv::Mat carriedByTruth(const cv::Mat& image, const Vec3& from, const Vec3& to) {
  const double scale = from.z() / to.z();
  const cv::Matx23d similarity{scale, 0,     to.x() - scale * from.x(),
                               0,     scale, to.y() - scale * from.y()};
  cv::Mat out;
  cv::warpAffine(image, out, similarity, image.size(), cv::INTER_NEAREST);
  return out;
}

}  // namespace

Vec2 centroidOf_px(const cv::Mat& mask) {
  const cv::Moments moments = cv::moments(mask, true);
  if (moments.m00 <= 0) return {0, 0};
  return {moments.m10 / moments.m00 + 0.5, moments.m01 / moments.m00 + 0.5};
}

std::vector<NamedSensor> sensors() {
  Sensor stereo;
  stereo.depth = Sensor::Depth::kStereo;
  stereo.jpeg = true;
  Sensor shifted = stereo;
  shifted.misalignment_px = 4;
  Sensor flight = stereo;
  flight.depth = Sensor::Depth::kTimeOfFlight;
  flight.misalignment_px = 2;
  Sensor coarse = stereo;
  coarse.depth = Sensor::Depth::kEightBit;
  return {{"rs0", stereo}, {"rs4", shifted}, {"tof2", flight}, {"b8", coarse}};
}

std::vector<Clip> renderClips(const TestScene& scene, const std::vector<NamedSensor>& sensors,
                              const ClipSize& size) {
  std::vector<Clip> clips;
  std::vector<TestSource> sources;
  sources.reserve(sensors.size());
  for (const NamedSensor& sensor : sensors) {
    sources.emplace_back(scene, sensor.sensor, 25.0, true, size.width_px, size.height_px);
    TestSource& source = sources.back();
    source.sharePictures(sources.front());
    Clip clip{scene.name, sensor.name, source.info(), {}, {}, {}};
    while (clip.frames.size() < size.frames) {
      auto frame = source.read();
      if (!frame) break;
      clip.frames.push_back(std::move(*frame));
    }
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      // Truth is the same for all sensors: its pictures are shared.
      clip.truth.push_back(clips.empty() ? source.truth(i) : clips.front().truth[i]);
      const Vec3 at = clip.truth[i].centre.position_mm;
      const Vec2 px = source.view().workspace.toImage({at.x(), at.y()});
      const server::DepthRange range = source.view().range;
      const double depth = range.far_mm - at.z() / 30.0 * (range.far_mm - range.near_mm);
      clip.centre.emplace_back(px.x(), px.y(), depth);
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

MaskRun runSegmenter(const Clip& clip, server::SegmentMode mode, Method method) {
  MaskRun out;
  Stages stages(clip, mode, method);
  StageTimes first;
  try {
    for (std::size_t i = 0; i < clip.frames.size(); ++i)
      out.masks.push_back(stages.next(clip.frames[i], i == 0 ? first : out.times));
  } catch (const server::SourceError& error) {  // nothing under the point: never an object
    std::fprintf(stderr, "%s: %s\n", clip.name().c_str(), error.what());
    out.masks.assign(clip.frames.size(), cv::Mat());
  }
  out.start_us = first.segmentation();
  const double frames = std::max<double>(1.0, double(clip.frames.size()) - 1.0);
  for (double* time :
       {&out.times.view, &out.times.track, &out.times.segment, &out.times.clean, &out.times.relief})
    *time /= frames;
  return out;
}

MaskErrors errorsOf(const MaskRun& run, const Clip& clip) {
  MaskErrors out;
  std::vector<double> errors;
  cv::Mat last_more;
  cv::Mat last_less;
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    const cv::Mat& truth = clip.truth[i].mask;
    const cv::Mat none = cv::Mat::zeros(truth.size(), CV_8UC1);
    const cv::Mat& mask = run.masks[i].empty() ? none : run.masks[i];
    if (run.masks[i].empty()) ++out.lost;
    const int either = cv::countNonZero(mask | truth);
    errors.push_back(either > 0 ? 1.0 - double(cv::countNonZero(mask & truth)) / either : 0.0);
    const cv::Mat more = mask & ~truth;
    const cv::Mat less = truth & ~mask;
    if (i > 0) {
      const Vec3& from = clip.centre[i - 1];
      const int changed = cv::countNonZero(carriedByTruth(last_more, from, clip.centre[i]) ^ more) +
                          cv::countNonZero(carriedByTruth(last_less, from, clip.centre[i]) ^ less);
      out.flicker += changed / std::max(1.0, double(cv::countNonZero(truth)));
    }
    last_more = more;
    last_less = less;
  }
  const std::size_t count = std::max<std::size_t>(1, errors.size());
  for (const double error : errors) out.mask += error / double(count);
  if (!errors.empty()) out.first = errors.front();
  std::sort(errors.begin(), errors.end());
  out.worst = errors.empty() ? 0.0 : errors[errors.size() * 95 / 100];
  out.flicker /= std::max<double>(1.0, double(count) - 1.0);
  return out;
}

}  // namespace hapticast::evaluate
