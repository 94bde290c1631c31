// SPDX-License-Identifier: MIT
// Small synthetic RGB-D frames with known truth, and the real clips, for the tests of vision.
#pragma once

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "common/geometry.hpp"
#include "tests/scenes/drawn_source.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::server::test {

/// Smooth noise that does not repeat, 0..1; the object's and the background's paint.
inline double paint(double x, double y) {
  return 0.5 + 0.17 * std::sin(0.31 * x + 0.7 * std::sin(0.13 * y)) +
         0.17 * std::sin(0.27 * y + std::sin(0.11 * x)) +
         0.15 * std::sin(0.17 * (x + y) + 2 * std::sin(0.05 * (x - y)));
}

/// A textured ball before a wall, seen by a pinhole camera.
struct BallScene {
  int width = 320, height = 240;
  double radius_px = 40;
  double near_mm = 700;  ///< of the ball's front
  double bulge_mm = 80;  ///< front to rim: its radius
  double background_mm = 1200;
  DepthKind kind = DepthKind::kMetric;
  bool with_mask = true;
  double turn_rad = 0;  ///< of its paint about the vertical axis

  [[nodiscard]] CameraModel camera() const {
    const double focal_px = radius_px * (near_mm + bulge_mm) / bulge_mm;
    return {focal_px, focal_px, 0.5 * width, 0.5 * height};
  }
  [[nodiscard]] SourceInfo info(double fps = 25.0) const {
    SourceInfo out;
    out.name = "ball";
    out.width_px = width;
    out.height_px = height;
    out.fps = fps;
    out.depth_kind = kind;
    out.camera = camera();
    return out;
  }
  /// Depth of a ball whose centre projects to `centre_px`, at a place of the picture; 0 beside it.
  [[nodiscard]] double ballDepth(const Vec2& at_px, const Vec2& centre_px,
                                 double closer_mm = 0) const {
    const Vec3 ray = rayThrough(at_px);
    const Vec3 centre = (near_mm + bulge_mm - closer_mm) * rayThrough(centre_px);
    const double a = ray.squaredNorm();
    const double b = ray.dot(centre);
    const double rest = b * b - a * (centre.squaredNorm() - bulge_mm * bulge_mm);
    return rest > 0 ? (b - std::sqrt(rest)) / a : 0.0;
  }
  /// The ball's centre at (u, v), pixel centres at +0.5, and nearer by `closer_mm`.
  [[nodiscard]] RgbdFrame frame(std::uint64_t index, double u, double v,
                                double closer_mm = 0) const {
    RgbdFrame out;
    out.index = index;
    out.color.create(height, width, CV_8UC3);
    out.depth.create(height, width, CV_32FC1);
    cv::Mat mask = cv::Mat::zeros(height, width, CV_8UC1);
    const Vec3 centre = (near_mm + bulge_mm - closer_mm) * rayThrough({u, v});
    const double px_per_mm = radius_px / bulge_mm;
    for (int j = 0; j < height; ++j) {
      for (int i = 0; i < width; ++i) {
        const Vec2 at(i + 0.5, j + 0.5);
        const double ball = ballDepth(at, {u, v}, closer_mm);
        const bool inside = ball > 0;
        const Vec3 on_ball = px_per_mm * (ball * rayThrough(at) - centre);
        const double turned_x = std::cos(turn_rad) * on_ball.x() + std::sin(turn_rad) * on_ball.z();
        const double light =
            inside ? paint(turned_x * 0.8 + 40, on_ball.y() * 0.8) : paint(i, j + 300);
        const double level = 40 + 200 * light;
        out.color.at<cv::Vec3b>(j, i) =
            inside
                ? cv::Vec3b(cv::saturate_cast<uchar>(0.2 * level),
                            cv::saturate_cast<uchar>(0.5 * level), cv::saturate_cast<uchar>(level))
                : cv::Vec3b(cv::saturate_cast<uchar>(level), cv::saturate_cast<uchar>(0.8 * level),
                            cv::saturate_cast<uchar>(0.3 * level));
        const double z = inside ? ball : background_mm;
        out.depth.at<float>(j, i) =
            static_cast<float>(kind == DepthKind::kHeight ? std::round(255 * (1000 - z) / 400) : z);
        if (kind == DepthKind::kHeight)
          out.depth.at<float>(j, i) = std::max(0.0F, out.depth.at<float>(j, i));
        if (inside) mask.at<uchar>(j, i) = 1;
      }
    }
    if (with_mask) out.mask = mask;
    return out;
  }

 private:
  [[nodiscard]] Vec3 rayThrough(const Vec2& at_px) const {
    return camera().ray(at_px.x(), at_px.y());
  }
};

using hapticast::test::clipsFolder;

/// Frame `index` of a real clip (layout of the clips folder); nullopt past its end or where there
/// is none.
inline std::optional<RgbdFrame> clipFrame(const std::string& clip, std::uint64_t index) {
  char number[32];
  std::snprintf(number, sizeof number, "%06d", static_cast<int>(index));
  const std::filesystem::path folder = clipsFolder() / clip;
  RgbdFrame out;
  out.index = index;
  for (const char* ending : {".jpg", ".png"}) {
    const auto path = folder / "rgb" / (std::string(number) + ending);
    if (std::filesystem::exists(path)) out.color = cv::imread(path.string());
  }
  if (out.color.empty()) return std::nullopt;
  const cv::Mat depth = cv::imread((folder / "depth" / (std::string(number) + ".png")).string(),
                                   cv::IMREAD_UNCHANGED);
  depth.convertTo(out.depth, CV_32F);
  return out;
}

inline SourceInfo clipInfo(const std::string& clip, double fps) {
  SourceInfo info;
  info.name = clip;
  info.fps = fps;
  if (const auto first = clipFrame(clip, 0)) {
    info.width_px = first->color.cols;
    info.height_px = first->color.rows;
  }
  return info;
}

}  // namespace hapticast::server::test
