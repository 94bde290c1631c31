// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/figures/figures_parts.hpp"
#include "tests/scenes/body_scene.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

const cv::Size kTile(400, 300);
constexpr int kHead_px = 26;

/// Result of one method for the clip's frame `index`.
struct Seen {
  cv::Mat color, depth, mask, height;
};

cv::Mat inColors(const cv::Mat& values, const cv::Mat& known) {
  double low = 0;
  double high = 1;
  cv::minMaxLoc(values, &low, &high, nullptr, nullptr, known);
  cv::Mat gray;
  values.convertTo(gray, CV_8U, 255.0 / std::max(1e-9, high - low),
                   -255.0 * low / std::max(1e-9, high - low));
  cv::Mat out;
  cv::applyColorMap(gray, out, cv::COLORMAP_VIRIDIS);
  out.setTo(cv::Scalar(30, 30, 30), known == 0);
  return out;
}

Seen look(server::RgbdSource& source, const server::VisionSettings& settings, std::uint64_t index) {
  server::Vision vision(source.info(), settings);
  Seen out;
  std::optional<server::VisionResult> wanted;
  std::uint64_t count = 0;
  const auto take = [&](server::VisionResult&& result) {
    if (count++ == index) wanted = std::move(result);
  };
  for (std::uint64_t i = 0; !wanted; ++i) {
    const auto frame = source.read();
    if (!frame) break;
    if (i == index) out.depth = frame->depth.clone();
    if (auto result = vision.push(*frame, mediaTime(double(i) / source.info().fps)))
      take(std::move(*result));
  }
  for (server::VisionResult& result : vision.flush()) take(std::move(result));
  if (!wanted) throw std::runtime_error("a clip for figure 2 is shorter than it should be");
  out.color = wanted->color;
  out.mask = cv::Mat::zeros(out.color.size(), CV_8UC1);
  out.height = cv::Mat::zeros(out.color.size(), CV_32FC1);
  for (const HapticObject& object : wanted->frame.objects) {
    const PixelRect& rect = object.relief->rect;
    for (int v = 0; v < rect.height; ++v) {
      for (int u = 0; u < rect.width; ++u) {
        const auto i = static_cast<std::size_t>(v * rect.width + u);
        if (object.relief->mask[i] == 0) continue;
        out.mask.at<uchar>(rect.v + v, rect.u + u) = 255;
        out.height.at<float>(rect.v + v, rect.u + u) = object.relief->height_mm[i];
      }
    }
  }
  return out;
}

void put(cv::Mat& sheet, int row, int column, const cv::Mat& picture, const std::string& words) {
  cv::Mat small;
  cv::resize(picture, small, kTile, 0, 0, cv::INTER_AREA);
  const cv::Point at(column * kTile.width, row * (kTile.height + kHead_px));
  small.copyTo(sheet(cv::Rect(at + cv::Point(0, kHead_px), kTile)));
  cv::putText(sheet, words, at + cv::Point(6, 18), cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar(20, 20, 20), 1, cv::LINE_AA);
}

void putRow(cv::Mat& sheet, int row, const Seen& seen, const std::string& words) {
  put(sheet, row, 0, seen.color, words + ": frame");
  put(sheet, row, 1, inColors(seen.depth, seen.depth > 0), "depth");
  cv::Mat mask;
  cv::cvtColor(seen.mask, mask, cv::COLOR_GRAY2BGR);
  put(sheet, row, 2, mask, "mask");
  put(sheet, row, 3, inColors(seen.height, seen.mask), "enhanced depth");
}

}  // namespace

void drawPictures(const Options& options) {
  const std::filesystem::path clip = test::clipsFolder() / "visp_rbt_desk";
  const bool real = std::filesystem::exists(clip);
  const int rows = real ? 4 : 2;
  cv::Mat sheet(rows * (kTile.height + kHead_px), 4 * kTile.width, CV_8UC3, cv::Scalar::all(255));
  int row = 0;
  for (const Method method : {Method::kThesis, Method::kHapticast}) {
    server::VisionSettings settings;
    settings.method = method;
    const std::string name = method == Method::kThesis ? "thesis" : "hapticast";
    Sensor sensor;
    sensor.depth = Sensor::Depth::kEightBit;
    for (const TestScene& scene : segmentationScenes()) {
      if (scene.name != "ball_air") continue;
      TestSource source(scene, sensor, 25.0, false);
      settings.object_points = {
          {source.view().workspace.toImage(source.centreAt(0.0).position_mm.head<2>())}};
      putRow(sheet, row, look(source, settings, 10), name + ", ball");
    }
    if (real) {
      const auto source = server::openSource(clip.string(), 0.0);
      settings.object_points = {{{505, 330}}};
      putRow(sheet, row + 2, look(*source, settings, 10), name + ", dragon");
    }
    ++row;
  }
  const std::filesystem::path file = options.out / "figure_2.png";
  if (!cv::imwrite(file.string(), sheet)) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace hapticast::evaluate
