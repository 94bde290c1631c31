// SPDX-License-Identifier: MIT
#include "tests/scenes/relief_scene.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "server/source/synthetic/synthetic_source.hpp"
#include "tests/scenes/drawn_source.hpp"

namespace hapticast::evaluate {

namespace {

constexpr int kWidth_px = 640, kHeight_px = 480;
// One px is one mm wide and nominal z has the scale of x and y. At this distance the nearest and
// the farthest point of a body are shown in scales that differ by 0.2 %.
constexpr double kDistance_mm = 60'000.0;
constexpr double kMmPerNominal = 4.0;
constexpr double kMappedDepth_mm = 30.0;

class ReliefSource final : public server::test::DrawnSource {
 public:
  ReliefSource(const ReliefBody& body, const Seen& seen) : body_(body), seen_(seen) {
    info_.name = body.name;
    info_.width_px = kWidth_px;
    info_.height_px = kHeight_px;
    info_.fps = kSceneFps;
    info_.depth_kind = seen.eight_bit ? server::DepthKind::kHeight : server::DepthKind::kMetric;
    info_.frame_count = static_cast<std::uint64_t>(std::llround(body.duration_s * kSceneFps));
    info_.depth_range = {kDistance_mm - kMmPerNominal * kMappedDepth_mm, kDistance_mm};
    info_.camera = {kDistance_mm, kDistance_mm, 0.5 * kWidth_px, 0.5 * kHeight_px};
    background_ = cv::Mat(kHeight_px, kWidth_px, CV_8UC3);
    for (int v = 0; v < kHeight_px; ++v) {
      for (int u = 0; u < kWidth_px; ++u) {
        const float part = noise_.at({double(u), double(v), 300.0});
        background_.at<cv::Vec3b>(v, u) = server::mix({70, 60, 45}, {150, 140, 115}, part, 1.0F);
      }
    }
  }

 private:
  server::RgbdFrame draw(std::uint64_t index) override {
    if (!body_.still || last_.color.empty()) drawAt(static_cast<double>(index) / kSceneFps);
    server::RgbdFrame frame = last_;
    if (!seen_.give_mask) frame.mask = cv::Mat();
    return frame;
  }

  void drawAt(double time_s) {
    last_.color = background_.clone();
    // Behind all that is mapped: 0 as a height, and a wall as a depth.
    last_.depth = cv::Mat(background_.size(), CV_32FC1,
                          cv::Scalar(seen_.eight_bit ? 0.0 : kDistance_mm + 100.0));
    last_.mask = cv::Mat::zeros(background_.size(), CV_8UC1);
    const Workspace workspace;
    const Motion motion = body_.motion(time_s);
    const Eigen::Rotation2Dd back(-motion.angle_rad);
    const Vec2 middle_px = workspace.toImage(motion.position_mm.head<2>());
    const int reach_px = static_cast<int>(body_.reach_mm / workspace.mmPerPixel().x()) + 2;
    const int u0 = std::max(0, int(middle_px.x()) - reach_px);
    const int u1 = std::min(kWidth_px, int(middle_px.x()) + reach_px);
    const int v0 = std::max(0, int(middle_px.y()) - reach_px);
    const int v1 = std::min(kHeight_px, int(middle_px.y()) + reach_px);
    for (int v = v0; v < v1; ++v) {
      for (int u = u0; u < u1; ++u) {
        const Vec2 at_mm = workspace.toNominal({u + 0.5, v + 0.5});
        const Vec2 in_body = back * (at_mm - motion.position_mm.head<2>());
        const double above = body_.height_mm(in_body, time_s);
        if (std::isnan(above)) continue;
        paint(u, v, above + motion.position_mm.z(), in_body, above, time_s);
      }
    }
  }

  void paint(int u, int v, double height_mm, const Vec2& in_body, double above, double time_s) {
    last_.mask.at<uchar>(v, u) = 1;
    auto& depth = last_.depth.at<float>(v, u);
    if (seen_.eight_bit)
      depth = static_cast<float>(
          std::clamp(std::round(height_mm / kMappedDepth_mm * 255.0), 0.0, 255.0));
    else
      depth = static_cast<float>(kDistance_mm - kMmPerNominal * height_mm);
    Vec2 slope = gradientOf(body_.height_mm, in_body, time_s);
    if (!slope.allFinite()) slope.setZero();  // at the rim
    const float part = noise_.at(kMmPerNominal * Vec3(in_body.x(), in_body.y(), above));
    // The normal in the camera's frame: Y down, Z away.
    last_.color.at<cv::Vec3b>(v, u) = server::mix(
        {30, 60, 140}, {130, 215, 250}, part, server::brightness({-slope.x(), slope.y(), -1.0}));
  }

  ReliefBody body_;
  Seen seen_;
  server::SolidNoise noise_;
  cv::Mat background_;
  server::RgbdFrame last_;
};

}  // namespace

Vec2 TouchScene::objectPoint_px() const {
  return Workspace{}.toImage(motion(0.0).position_mm.head<2>());
}

TouchScene reliefScene(const ReliefBody& body) {
  TouchScene out;
  out.name = body.name;
  out.duration_s = body.duration_s;
  out.motion = body.motion;
  out.height_mm = [body](const Vec2& nominal_mm, double time_s) {
    const Motion motion = body.motion(time_s);
    const Eigen::Rotation2Dd back(-motion.angle_rad);
    return body.height_mm(back * (nominal_mm - motion.position_mm.head<2>()), time_s) +
           motion.position_mm.z();
  };
  out.open = [body](const Seen& seen) { return std::make_unique<ReliefSource>(body, seen); };
  return out;
}

Vec2 turned(const Vec2& v, double angle_rad) { return Eigen::Rotation2Dd(angle_rad) * v; }

Vec2 gradientOf(const HeightAt& height_mm, const Vec2& at, double time_s) {
  constexpr double kStep_mm = 1e-4;
  const Vec2 x(kStep_mm, 0.0);
  const Vec2 y(0.0, kStep_mm);
  return Vec2(height_mm(at + x, time_s) - height_mm(at - x, time_s),
              height_mm(at + y, time_s) - height_mm(at - y, time_s)) /
         (2.0 * kStep_mm);
}

}  // namespace hapticast::evaluate
