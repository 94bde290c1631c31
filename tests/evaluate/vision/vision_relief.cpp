// SPDX-License-Identifier: MIT
// Reliefs against the true surface, and the noise at rest.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "server/vision/base/masks.hpp"
#include "server/vision/surface/range.hpp"
#include "server/vision/tracker.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"

namespace hapticast::evaluate {

namespace {

using server::Surface;

constexpr double kFingerBelow_mm = 2.0;

}  // namespace

Reliefs reliefsOf(const Clip& clip, server::SegmentMode mode, Method method) {
  server::VisionSettings settings;
  settings.segment = mode;
  settings.method = method;
  settings.object_points = {{centroidOf_px(clip.truth[0].mask)}};
  std::uint32_t next_id = 1;
  server::ClipAnnotations annotations;
  server::Tracker tracker(clip.info, settings, nullptr, next_id, annotations);
  server::RangeFinder finder;
  std::vector<std::optional<Surface>> surfaces;
  for (std::size_t i = 0; i < clip.frames.size(); ++i) {
    const auto objects = tracker.next(clip.frames[i], double(i) / clip.info.fps);
    surfaces.emplace_back();
    if (objects.empty() || !objects[0].seen) continue;
    surfaces.back() = objects[0].surface;
    finder.add(objects[0].id, objects[0].surface, tracker.noise());
  }
  Reliefs out;
  const auto mapped = finder.range(0.05);
  out.range = mapped ? mapped->range : *clip.info.depth_range;
  Workspace workspace;
  workspace.width_px = clip.info.width_px;
  workspace.height_px = clip.info.height_px;
  for (const auto& surface : surfaces) {
    cv::Mat whole(clip.info.height_px, clip.info.width_px, CV_32FC1, cv::Scalar(NAN));
    if (surface) {
      const double start_us = threadTime_us();
      const auto relief = makeRelief(*surface, out.range, workspace, method);
      out.time_us += (threadTime_us() - start_us) / double(surfaces.size());
      std::vector<float> heights = relief->height_mm;
      const cv::Mat part(surface->box.size(), CV_32FC1, heights.data());
      part.copyTo(whole(surface->box), surface->mask);
    }
    out.height_mm.push_back(whole);
  }
  return out;
}

namespace {

struct ReliefErrors {
  double inside_mm = 0, rim_mm = 0;
};

ReliefErrors errorsOf(const Reliefs& reliefs, const Clip& clip) {
  double sum[2] = {0, 0};
  double count[2] = {1e-9, 1e-9};
  const double gain = 30.0 / (reliefs.range.far_mm - reliefs.range.near_mm);
  for (std::size_t i = 0; i < reliefs.height_mm.size(); ++i) {
    const TestSource::Truth& truth = clip.truth[i];
    const cv::Mat core = server::erodeBy(truth.mask, 5);
    for (int v = 0; v < core.rows; ++v) {
      const auto* mask = truth.mask.ptr<unsigned char>(v);
      const auto* inner = core.ptr<unsigned char>(v);
      const auto* height = reliefs.height_mm[i].ptr<float>(v);
      const auto* depth = truth.depth.ptr<float>(v);
      for (int u = 0; u < core.cols; ++u) {
        if (mask[u] == 0 || std::isnan(height[u])) continue;
        const double exact =
            std::clamp((reliefs.range.far_mm - double(depth[u])) * gain, 0.0, 30.0);
        const std::size_t part = inner[u] != 0 ? 0 : 1;
        sum[part] += std::pow(double(height[u]) - exact, 2);
        count[part] += 1;
      }
    }
  }
  return {std::sqrt(sum[0] / count[0]), std::sqrt(sum[1] / count[1])};
}

}  // namespace

double forceNoise_N(const std::vector<cv::Mat>& heights_mm, std::size_t from, std::size_t to,
                    double mm_per_px) {
  const cv::Size size = heights_mm[0].size();
  cv::Mat mean = cv::Mat::zeros(size, CV_32FC1);
  for (std::size_t i = from; i < to; ++i) mean += heights_mm[i] / double(to - from);
  double pooled = 0;
  std::size_t pixels = 0;
  for (int v = 1; v + 1 < size.height; ++v) {
    for (int u = 1; u + 1 < size.width; ++u) {
      if (std::isnan(mean.at<float>(v, u))) continue;
      Vec3 sum = Vec3::Zero();
      double squares = 0;
      for (std::size_t i = from; i < to; ++i) {
        const cv::Mat& h = heights_mm[i];
        const Vec3 towards(-double(h.at<float>(v, u + 1) - h.at<float>(v, u - 1)) / (2 * mm_per_px),
                           double(h.at<float>(v + 1, u) - h.at<float>(v - 1, u)) / (2 * mm_per_px),
                           1.0);
        const double depth_mm = double(h.at<float>(v, u) - mean.at<float>(v, u)) + kFingerBelow_mm;
        const Vec3 force = kStiffness_N_mm * depth_mm / towards.squaredNorm() * towards;
        sum += force;
        squares += force.squaredNorm();
      }
      const double n = double(to - from);
      const double variance = squares / n - (sum / n).squaredNorm();
      if (std::isnan(variance)) continue;  // at the mask's edge
      pooled += std::max(0.0, variance);
      ++pixels;
    }
  }
  return std::sqrt(pooled / std::max<double>(1.0, double(pixels)));
}

void measureReliefs(const Clip& clip, Report& report) {
  for (const Method method : {Method::kHapticast, Method::kThesis}) {
    const bool thesis = method == Method::kThesis;
    const char* name = thesis ? "thesis" : "hapticast";
    const Reliefs reliefs = reliefsOf(clip, server::SegmentMode::kSource, method);
    const ReliefErrors errors = errorsOf(reliefs, clip);
    report.add({clip.name(), "relief", name, errors.inside_mm, "mm rms inside", reliefs.time_us,
                !thesis, thesis});
    report.add({clip.name(), "relief at the rim", name, errors.rim_mm, "mm rms in the 5 px rim",
                reliefs.time_us, !thesis, thesis});
    if (clip.scene != "still" || clip.frames.size() <= kSettled) continue;
    const Reliefs found = reliefsOf(clip, server::SegmentMode::kBand, method);
    const double mm_per_px = 160.0 / clip.info.width_px;
    report.add({clip.name() + " at first", "rest", name,
                forceNoise_N(found.height_mm, 0, kSettled, mm_per_px), "N rms", found.time_us,
                !thesis, thesis});
    report.add({clip.name(), "rest", name,
                forceNoise_N(found.height_mm, kSettled, found.height_mm.size(), mm_per_px), "N rms",
                found.time_us, !thesis, thesis});
  }
}

}  // namespace hapticast::evaluate
