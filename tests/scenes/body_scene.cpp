// SPDX-License-Identifier: MIT
#include "tests/scenes/body_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/source/synthetic/synthetic_source.hpp"

namespace hapticast::evaluate {

namespace {

using server::brightness;
using server::mix;

constexpr double kTilt_rad = 35.0 * CV_PI / 180.0;
constexpr double kTableDistance_mm = 1000.0;
constexpr double kWall_mm = 1250.0;

server::SceneView makeView(const TestScene& scene, int width_px, int height_px) {
  server::SceneView view;
  view.workspace.width_px = width_px;
  view.workspace.height_px = height_px;
  const double focal_px = 600.0 * std::min(width_px / 640.0, height_px / 480.0);
  view.camera = {focal_px, focal_px, 0.5 * width_px, 0.5 * height_px};
  view.range = scene.range;
  return view;
}

// The nearest hit of `ray` (z = 1) with a box about the origin of the body frame.
struct BoxHit {
  double z;
  Vec3 normal;  // body frame
};
std::optional<BoxHit> hitBox(const Vec3& origin, const Vec3& ray, const Vec3& half) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  int face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(ray[axis]) < 1e-12) {
      if (std::abs(origin[axis]) > half[axis]) return std::nullopt;
      continue;
    }
    const double a = (-half[axis] - origin[axis]) / ray[axis];
    const double b = (half[axis] - origin[axis]) / ray[axis];
    if (std::min(a, b) > enter) {
      enter = std::min(a, b);
      face = axis;
    }
    leave = std::min(leave, std::max(a, b));
  }
  if (face < 0 || enter > leave || enter <= 0) return std::nullopt;
  Vec3 normal = Vec3::Zero();
  normal[face] = ray[face] > 0 ? -1.0 : 1.0;
  return BoxHit{enter, normal};
}

}  // namespace

TestSource::TestSource(TestScene scene, Sensor sensor, double fps, bool give_mask, int width_px,
                       int height_px, std::uint64_t seed)
    : scene_(std::move(scene)),
      sensor_(sensor),
      give_mask_(give_mask),
      seed_(seed),
      view_(makeView(scene_, width_px, height_px)) {
  info_.name = scene_.name;
  info_.width_px = width_px;
  info_.height_px = height_px;
  info_.fps = fps;
  info_.depth_kind = sensor_.depth == Sensor::Depth::kEightBit ? server::DepthKind::kHeight
                                                               : server::DepthKind::kMetric;
  info_.frame_count = static_cast<std::uint64_t>(std::llround(scene_.duration_s * fps));
  info_.depth_range = view_.range;
  info_.camera = view_.camera;
  if (scene_.pan_px == 0.0) {
    Picture still;
    still.color = cv::Mat::zeros(height_px, width_px, CV_8UC3);
    still.depth.create(height_px, width_px, CV_32FC1);
    drawBackground(0.0, true, still);
    background_ = still;
  }
  cv::RNG random(seed_);
  sensor_state_.fixed_noise = makeNoise(random, {width_px, height_px}, 0.0);
}

double TestSource::panAt_px(double time_s) const {
  return scene_.pan_px * std::sin(2 * CV_PI * scene_.pan_hz * time_s) * info_.width_px / 640.0;
}

double TestSource::panSpeedAt_px_s(double time_s) const {
  const double turn = 2 * CV_PI * scene_.pan_hz;
  return scene_.pan_px * turn * std::cos(turn * time_s) * info_.width_px / 640.0;
}

void TestSource::drawBackground(double time_s, bool color, Picture& out) const {
  const double mm_per_px = 640.0 / info_.width_px;
  const double pan_px = panAt_px(time_s);
  const cv::Vec3f dark = scene_.same_colors ? scene_.bodies[0].dark : cv::Vec3f{70, 60, 45};
  const cv::Vec3f light = scene_.same_colors ? scene_.bodies[0].light : cv::Vec3f{150, 140, 115};
  for (int v = 0; v < info_.height_px; ++v) {
    const double y = (v + 0.5 - view_.camera.cy_px) / view_.camera.fy_px;
    const double slope = std::sin(kTilt_rad) + y * std::cos(kTilt_rad);
    const double z = scene_.table ? kTableDistance_mm * std::sin(kTilt_rad) / slope : kWall_mm;
    auto* row = out.color.ptr<cv::Vec3b>(v);
    auto* depth = out.depth.ptr<float>(v);
    for (int u = 0; u < info_.width_px; ++u) {
      depth[u] = static_cast<float>(z);
      if (!color) continue;
      const double x = (u - pan_px) * mm_per_px;
      row[u] =
          mix(dark, light, noise_.at({x, v * mm_per_px * (scene_.table ? 1.6 : 1.0), 300.0}), 1.0F);
    }
  }
}

void TestSource::drawBody(const Body& body, std::size_t index, double time_s, bool color,
                          Picture& out) const {
  const server::BodyState state = body.path(time_s);
  const double pan_px = panAt_px(time_s);
  const server::SceneInstant ellipsoid(view_, state, body.half_size_mm, 0.0);
  const bool box = body.shape == Shape::kBox;
  PixelRect reach = ellipsoid.boundingBox();
  if (box) {  // its circumscribed ball
    const double radius = body.half_size_mm.norm();
    reach = server::SceneInstant(view_, state, Vec3::Constant(radius), 0.0).boundingBox();
  }
  const int shift = static_cast<int>(std::lround(pan_px));
  const Eigen::Matrix3d to_body = state.rotation.transpose();
  const Vec3 origin = to_body * -state.position_mm;
  for (int v = reach.v; v < reach.v + reach.height; ++v) {
    for (int u = std::max(0, reach.u + shift - 1);
         u < std::min(info_.width_px, reach.u + reach.width + shift + 1); ++u) {
      const Vec2 image(u + 0.5 - pan_px, v + 0.5);
      Vec3 position;
      Vec3 normal;
      if (box) {
        const Vec3 ray = view_.camera.ray(image.x(), image.y());
        const auto hit = hitBox(origin, to_body * ray, body.half_size_mm);
        if (!hit) continue;
        position = hit->z * ray;
        normal = state.rotation * hit->normal;
      } else {
        const auto hit = ellipsoid.hit(image);
        if (!hit) continue;
        position = hit->position_mm;
        normal = hit->normal;
      }
      if (body.is_object) out.object_px += 1.0;
      auto& depth = out.depth.at<float>(v, u);
      if (static_cast<float>(position.z()) >= depth) continue;
      depth = static_cast<float>(position.z());
      out.body.at<uchar>(v, u) = static_cast<uchar>(index + 1);
      if (!color) continue;
      const float part = body.textured ? noise_.at(to_body * (position - state.position_mm)) : 0.5F;
      out.color.at<cv::Vec3b>(v, u) = mix(body.dark, body.light, part, brightness(normal));
    }
  }
}

TestSource::Picture TestSource::drawAt(double time_s, bool color) const {
  Picture out;
  const cv::Size size(info_.width_px, info_.height_px);
  if (background_.color.empty()) {
    out.color = cv::Mat::zeros(size, CV_8UC3);
    out.depth.create(size, CV_32FC1);
    drawBackground(time_s, color, out);
  } else {
    out.color = background_.color.clone();
    out.depth = background_.depth.clone();
  }
  out.body = cv::Mat::zeros(size, CV_8UC1);
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
    drawBody(scene_.bodies[i], i, time_s, color, out);
  return out;
}

void TestSource::sharePictures(TestSource& other) {
  if (other.shared_ == nullptr)
    other.shared_ = std::make_shared<std::map<std::uint64_t, Picture>>();
  shared_ = other.shared_;
}

TestSource::Picture TestSource::drawFrame(std::uint64_t index) const {
  const double time_s = static_cast<double>(index) / info_.fps;
  if (shared_ == nullptr) return drawAt(time_s, true);
  const auto known = shared_->find(index);
  if (known != shared_->end()) return known->second;
  return shared_->emplace(index, drawAt(time_s, true)).first->second;
}

cv::Mat TestSource::maskOf(const Picture& picture) const {
  cv::Mat mask = cv::Mat::zeros(picture.body.size(), CV_8UC1);
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    if (scene_.bodies[i].is_object) mask.setTo(255, picture.body == static_cast<double>(i + 1));
  }
  return mask;
}

// Colour as the sensor gives it, blurred by the exposure where the scene asks for it.
cv::Mat TestSource::drawColor(const Picture& picture, double time_s, cv::RNG& random) const {
  cv::Mat color = picture.color.clone();
  if (scene_.blur) {
    cv::Mat sum;
    picture.color.convertTo(sum, CV_32FC3);
    constexpr int kExposures = 8;
    for (int i = 1; i < kExposures; ++i) {
      cv::Mat part;
      drawAt(
          time_s + (double(i) / kExposures - 0.5 * (kExposures - 1) / kExposures) * 0.5 / info_.fps,
          true)
          .color.convertTo(part, CV_32FC3);
      sum += part;
    }
    sum.convertTo(color, CV_8UC3, 1.0 / kExposures);
  }
  if (sensor_.color_noise > 0) addColorNoise(color, sensor_.color_noise, random);
  return sensor_.jpeg ? compressJpeg(color, 80) : color;
}

server::RgbdFrame TestSource::draw(std::uint64_t index) {
  cv::RNG random(seed_ * 7919 + index + 1);
  const Picture picture = drawFrame(index);
  server::RgbdFrame frame;
  frame.color = drawColor(picture, static_cast<double>(index) / info_.fps, random);
  cv::Mat mask = maskOf(picture);
  frame.depth = senseDepth(sensor_, picture.depth, mask, view_.range, sensor_state_, random);
  if (!give_mask_) return frame;
  if (sensor_.mask_wobble_px > 0) mask = wobbleMask(mask, sensor_.mask_wobble_px, random);
  frame.mask = mask / 255;
  return frame;
}

Motion TestSource::centreAt(double time_s) const {
  const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                                 [](const Body& b) { return b.is_object; });
  const server::BodyState state = body->path(time_s);
  Motion out = view_.project(state.position_mm, state.velocity_mm_s, state.acceleration_mm_s2);
  const double mm_per_px = view_.workspace.mmPerPixel().x();
  out.position_mm.x() += panAt_px(time_s) * mm_per_px;
  out.velocity_mm_s.x() += panSpeedAt_px_s(time_s) * mm_per_px;
  out.angular_velocity_rad_s = -state.angular_velocity_rad_s.z();
  return out;
}

TestSource::Truth TestSource::truth(std::uint64_t index) const {
  const double time_s = static_cast<double>(index) / info_.fps;
  const Picture picture = shared_ != nullptr ? drawFrame(index) : drawAt(time_s, false);
  Truth out;
  out.centre = centreAt(time_s);
  out.mask = maskOf(picture);
  out.depth = picture.depth;
  out.visible_fraction =
      picture.object_px > 0 ? cv::countNonZero(out.mask) / picture.object_px : 0.0;
  return out;
}

}  // namespace hapticast::evaluate
