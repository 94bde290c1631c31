// SPDX-License-Identifier: MIT
#include "tests/evaluate/touch/touch_stream.hpp"

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "server/stream/encoded.hpp"
#include "server/vision/offline/offline_vision.hpp"
#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate {

namespace {

cv::Mat trueMask(const TouchScene& scene, double time_s, const Workspace& workspace) {
  cv::Mat out(workspace.height_px, workspace.width_px, CV_8UC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const Vec2 at_mm = workspace.toNominal({u + 0.5, v + 0.5});
      out.at<uchar>(v, u) = std::isnan(scene.height_mm(at_mm, time_s)) ? 0 : 1;
    }
  }
  return out;
}

cv::Mat sentMask(const HapticFrame& frame, const cv::Size& size) {
  cv::Mat out = cv::Mat::zeros(size, CV_8UC1);
  for (const HapticObject& object : frame.objects) {
    const PixelRect& rect = object.relief->rect;
    const cv::Mat mask(rect.height, rect.width, CV_8UC1,
                       const_cast<std::uint8_t*>(object.relief->mask.data()));
    out(cv::Rect(rect.u, rect.v, rect.width, rect.height)) |= mask;
  }
  return out;
}

double maskError_px(const TouchScene& scene, const HapticFrame& frame, const Workspace& workspace) {
  const cv::Mat truth = trueMask(scene, toSeconds(frame.media_time), workspace);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(truth, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  double length_px = 0;
  for (const auto& contour : contours) length_px += cv::arcLength(contour, true);
  return cv::countNonZero(truth != sentMask(frame, truth.size())) / std::max(1.0, length_px);
}

}  // namespace

namespace {

// `look` sees every frame before it is encoded, and may change it.
Stream play(server::RgbdSource& source, const server::VisionSettings& settings, bool scan,
            double longest_s, const SliceSettings& slices,
            const std::function<void(HapticFrame&, const Workspace&)>& look) {
  const server::SourceInfo info = source.info();
  server::Vision vision(info, settings);
  if (scan) vision.scan(source, nullptr);
  server::FrameEncoder encoder;
  Stream out;
  const auto take = [&](server::VisionResult& result) {
    look(result.frame, vision.description().workspace);
    out.frames.push_back(
        {toSeconds(result.frame.media_time), encoder.encode(result.frame, slices).delta});
  };
  while (auto frame = source.read()) {
    if (frame->clip_time_s > longest_s) break;
    const double start_us = threadTime_us();
    auto result = vision.push(*frame, mediaTime(double(frame->index) / info.fps));
    out.server_us += threadTime_us() - start_us;
    if (result) take(*result);
  }
  for (server::VisionResult& result : vision.flush()) take(result);
  out.description = vision.description();
  out.server_us /= std::max(1.0, double(out.frames.size()));
  return out;
}

}  // namespace

namespace {

Stream playOffline(server::RgbdSource& source, const server::VisionSettings& settings,
                   double longest_s, const SliceSettings& slices) {
  server::OfflineVision vision(source, source.info(), settings);
  vision.scan(nullptr);
  server::FrameEncoder encoder;
  Stream out;
  while (const auto result = vision.next()) {
    const double time_s = toSeconds(result->frame.media_time);
    if (time_s > longest_s) break;
    out.frames.push_back({time_s, encoder.encode(result->frame, slices).delta});
  }
  out.description = vision.vision().description();
  return out;
}

}  // namespace

Stream makeStream(const TouchScene& scene, const StreamKind& kind) {
  const auto source = scene.open(kind.seen);
  server::VisionSettings settings;
  settings.method = kind.method;
  settings.material = kind.material;
  settings.mass_kg = kind.mass_kg;
  if (!kind.seen.give_mask) {
    settings.object_points = {{scene.objectPoint_px()}};
    settings.segment =
        kind.method == Method::kThesis ? server::SegmentMode::kEdges : server::SegmentMode::kBand;
  }
  if (kind.offline) return playOffline(*source, settings, kind.longest_s, kind.slices);
  double mask_error_px = 0.0;
  std::size_t looked = 0;
  Stream out = play(*source, settings, kind.scan, kind.longest_s, kind.slices,
                    [&](HapticFrame& frame, const Workspace& workspace) {
                      if (kind.exact_pose) {
                        for (HapticObject& object : frame.objects)
                          object.motion = scene.motion(toSeconds(frame.media_time));
                      }
                      if (kind.seen.give_mask || frame.id % 5 != 0) return;
                      mask_error_px += maskError_px(scene, frame, workspace);
                      ++looked;
                    });
  out.mask_error_px = mask_error_px / std::max<double>(1.0, double(looked));
  return out;
}

Stream makeStream(server::RgbdSource& source, const server::VisionSettings& settings, bool scan) {
  return play(source, settings, scan, 1e9, StreamKind{}.slices,
              [](HapticFrame&, const Workspace&) {});
}

}  // namespace hapticast::evaluate
