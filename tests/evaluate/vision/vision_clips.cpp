// SPDX-License-Identifier: MIT
// Real captures: no truth, but an object must not be lost, and its outline changes little from
// frame to frame. Masks are to be looked at on the contact sheets.
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "server/source/rgbd_source.hpp"
#include "server/vision/base/flow.hpp"
#include "server/vision/tracker.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"
#include "tests/evaluate/vision/vision_sheet.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

struct RealObject {
  const char* clip;
  const char* name;
  Vec2 point_px;
};
const RealObject kObjects[] = {{"visp_rbt_desk", "dragon", {505, 330}},
                               {"visp_rbt_desk", "cube", {270, 300}},
                               {"visp_rbt_desk", "phantom", {430, 270}},
                               {"dkvfx_typing_person", "person", {125, 260}}};

struct Result {
  std::size_t frames = 0, lost = 0, ids = 0;
  double change = 0.0;   // mean share of the mask's area
  double time_us = 0.0;  // per frame, start and all
};

// Mask of the first object, empty where it is not seen.
cv::Mat maskOf(const std::vector<server::TrackedObject>& objects, const cv::Size& size) {
  for (const server::TrackedObject& object : objects) {
    if (!object.seen) continue;
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    object.surface.mask.copyTo(mask(object.surface.box));
    return mask;
  }
  return {};
}

double changeOf(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
                const cv::Mat& mask) {
  const server::ObjectFlow flow = server::trackObject(last_gray, gray, last_mask, {0, 0});
  const cv::Rect whole({0, 0}, mask.size());
  const cv::Mat carried =
      server::warpImage(last_mask, whole, whole, flow.similarity, cv::INTER_LINEAR) > 127;
  return double(cv::countNonZero(carried ^ mask)) / std::max(1, cv::countNonZero(mask));
}

Result follow(const RealObject& object, const Options& options) {
  const auto source = server::openSource((test::clipsFolder() / object.clip).string(), 0.0);
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points = {{object.point_px}};
  std::uint32_t next_id = 1;
  server::ClipAnnotations annotations;
  server::Tracker tracker(source->info(), settings, nullptr, next_id, annotations);
  ContactSheet sheet;
  Result out;
  std::size_t changes = 0;
  cv::Mat last_gray;
  cv::Mat last_mask;
  while (const auto frame = source->read()) {
    if (options.quick && out.frames >= 24) break;
    const double start_us = threadTime_us();
    const auto objects = tracker.next(*frame, double(out.frames) / source->info().fps);
    out.time_us += threadTime_us() - start_us;
    ++out.frames;
    const cv::Mat mask = maskOf(objects, frame->color.size());
    sheet.show(frame->color, mask);
    cv::Mat gray;
    cv::cvtColor(frame->color, gray, cv::COLOR_BGR2GRAY);
    if (mask.empty()) ++out.lost;
    if (!mask.empty() && !last_mask.empty()) {
      out.change += changeOf(last_gray, gray, last_mask, mask);
      ++changes;
    }
    last_gray = gray;
    last_mask = mask;
  }
  out.ids = next_id - 1;
  out.change /= std::max<double>(1.0, double(changes));
  out.time_us /= std::max<double>(1.0, double(out.frames));
  sheet.write(options.out / (std::string("vision_real_") + object.name + ".png"));
  return out;
}

}  // namespace

void measureRealClips(const Options& options, Report& report) {
  for (const RealObject& object : kObjects) {
    if (!std::filesystem::exists(test::clipsFolder() / object.clip)) {
      report.leaveOut(object.name);
      continue;
    }
    const Result result = follow(object, options);
    report.add({object.name, "lost", "band", double(result.lost), "frames", 0.0, true});
    report.add(
        {object.name, "change of the mask", "band", result.change, "share per frame", 0.0, true});
    std::fprintf(stderr, "%s: %zu of %zu frames without it, %zu ids; look at vision_real_%s.png\n",
                 object.name, result.lost, result.frames, result.ids, object.name);
  }
}

}  // namespace hapticast::evaluate
