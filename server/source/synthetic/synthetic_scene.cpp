// SPDX-License-Identifier: MIT
#include "server/source/synthetic/synthetic_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace hapticast::server {

namespace {

constexpr int kSide = 32;  // side of the lattice, a power of two

std::size_t cell(int x, int y, int z) {
  const auto wrapped = [](int i) { return static_cast<std::size_t>(i & (kSide - 1)); };
  return (wrapped(z) * kSide + wrapped(y)) * kSide + wrapped(x);
}

/// Trilinear interpolation with smoothed weights, for a continuous slope.
float interpolate(const std::vector<float>& lattice, const Vec3& p) {
  std::array<int, 3> base{};
  std::array<float, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double floor = std::floor(p[static_cast<Eigen::Index>(i)]);
    const auto t = static_cast<float>(p[static_cast<Eigen::Index>(i)] - floor);
    base[i] = static_cast<int>(floor);
    w[i] = t * t * (3.0F - 2.0F * t);
  }
  const int x = base[0];
  const int y = base[1];
  const int z = base[2];
  const auto along = [&](int dy, int dz) {
    return std::lerp(lattice[cell(x, y + dy, z + dz)], lattice[cell(x + 1, y + dy, z + dz)], w[0]);
  };
  return std::lerp(std::lerp(along(0, 0), along(1, 0), w[1]),
                   std::lerp(along(0, 1), along(1, 1), w[1]), w[2]);
}

}  // namespace

SolidNoise::SolidNoise() : lattice_(static_cast<std::size_t>(kSide * kSide * kSide)) {
  std::mt19937 random(20);
  // Not a std distribution: their results differ between standard libraries.
  std::generate(lattice_.begin(), lattice_.end(),
                [&] { return static_cast<float>(random() >> 8U) * 0x1p-24F; });
}

float SolidNoise::at(const Vec3& position_mm) const noexcept {
  const float sum = 0.45F * interpolate(lattice_, position_mm / 24.0) +
                    0.35F * interpolate(lattice_, position_mm / 12.0) +
                    0.20F * interpolate(lattice_, position_mm / 6.0);
  // The sum of octaves concentrates around 0.5; this spreads it.
  return std::clamp(0.5F + 1.9F * (sum - 0.5F), 0.0F, 1.0F);
}

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kDuration_s = 4.8;

constexpr double kBallRadius_mm = 60.0;
// Distance of the bouncing and the still ball, and mean distance of approach.
constexpr double kDistance_mm = 600.0;

// bounce: no impact coincides with a frame at 25 fps.
constexpr double kFloor_mm = 150.0;  // Y of the centre at the floor
constexpr double kFlight_s = 1.2;    // from floor to floor
constexpr double kGravity_mm_s2 = 8.0 * 280.0 / (kFlight_s * kFlight_s);  // 280 mm high
constexpr double kFirstFloor_s = 0.5;
constexpr double kWall_mm = 200.0;  // |X| of the centre at the walls
constexpr double kFirstWall_s = 1.46;
constexpr double kWallSpeed_mm_s = 4.0 * kWall_mm / kDuration_s;  // to and fro once per clip

constexpr double kApproach_mm = 100.0;
constexpr double kApproachPeriod_s = 2.4;

// tumble
constexpr double kTumbleRate_rad_s = kTwoPi / 2.4;
constexpr double kTumbleDistance_mm = 620.0;

/// t modulo period, in [0, period).
double wrap(double time_s, double period_s) {
  return time_s - period_s * std::floor(time_s / period_s);
}

/// One coordinate: position, velocity, acceleration in mm and s.
struct Coordinate {
  double x, v, a;
};

Coordinate sinusoid(double middle, double amplitude, double period_s, double phase_rad, double t) {
  const double omega = kTwoPi / period_s;
  const double angle = omega * t + phase_rad;
  return {middle + amplitude * std::sin(angle), amplitude * omega * std::cos(angle),
          -amplitude * omega * omega * std::sin(angle)};
}

Coordinate flight(double time_s) {
  const double t = wrap(time_s - kFirstFloor_s, kFlight_s);
  const double v0 = 0.5 * kGravity_mm_s2 * kFlight_s;
  return {kFloor_mm - v0 * t + 0.5 * kGravity_mm_s2 * t * t, -v0 + kGravity_mm_s2 * t,
          kGravity_mm_s2};
}

Coordinate computeBetweenWalls(double time_s) {
  const double t = wrap(time_s - kFirstWall_s, kDuration_s);
  const double back = t - 0.5 * kDuration_s;
  if (back < 0.0) return {kWall_mm - kWallSpeed_mm_s * t, -kWallSpeed_mm_s, 0.0};
  return {-kWall_mm + kWallSpeed_mm_s * back, kWallSpeed_mm_s, 0.0};
}

BodyState makeBodyState(const Coordinate& x, const Coordinate& y, const Coordinate& z) {
  BodyState body;
  body.position_mm = {x.x, y.x, z.x};
  body.velocity_mm_s = {x.v, y.v, z.v};
  body.acceleration_mm_s2 = {x.a, y.a, z.a};
  return body;
}

BodyState computeBodyState(SceneKind kind, double t) {
  constexpr Coordinate kZero{0.0, 0.0, 0.0};
  constexpr double kQuarter = 0.25 * kTwoPi;
  switch (kind) {
    case SceneKind::kBounce:
      return makeBodyState(computeBetweenWalls(t), flight(t), {kDistance_mm, 0.0, 0.0});
    case SceneKind::kApproach:
      return makeBodyState(kZero, kZero,
                           sinusoid(kDistance_mm, kApproach_mm, kApproachPeriod_s, kQuarter, t));
    case SceneKind::kTumble: {
      const Vec3 axis(0.6, 0.0, -0.8);
      BodyState body = makeBodyState(sinusoid(0.0, 110.0, kDuration_s, 0.0, t),
                                     sinusoid(0.0, 60.0, kDuration_s / 2.0, 0.7, t),
                                     sinusoid(kTumbleDistance_mm, 80.0, 2.4, kQuarter, t));
      body.rotation = Eigen::AngleAxisd(kTumbleRate_rad_s * t, axis).toRotationMatrix();
      body.angular_velocity_rad_s = kTumbleRate_rad_s * axis;
      return body;
    }
    case SceneKind::kStill:
      break;
  }
  return makeBodyState(kZero, kZero, {kDistance_mm, 0.0, 0.0});
}

/// Returns the depth range of the visible surface plus a margin. The outline of a tilted ellipsoid
/// may lie behind its centre.
DepthRange sceneRange(SceneKind kind) {
  switch (kind) {
    case SceneKind::kApproach:
      return {kDistance_mm - kApproach_mm - kBallRadius_mm - 20.0,
              kDistance_mm + kApproach_mm + 20.0};
    case SceneKind::kTumble:
      return {440.0, 760.0};
    case SceneKind::kBounce:
    case SceneKind::kStill:
      break;
  }
  return {kDistance_mm - kBallRadius_mm - 20.0, kDistance_mm + 20.0};
}

SceneView makeView(SceneKind kind, const Workspace& workspace) {
  const double focal_px = 600.0 * std::min(workspace.width_px / 640.0, workspace.height_px / 480.0);
  return {workspace,
          {focal_px, focal_px, 0.5 * workspace.width_px, 0.5 * workspace.height_px},
          sceneRange(kind)};
}

std::vector<SceneImpact> bounces(const SceneView& view) {
  std::vector<SceneImpact> impacts;
  const auto add = [&](double time_s, const Vec3& jump_mm_s) {
    // The projection is linear in velocity, so a jump maps like a velocity.
    const Vec3 where = computeBodyState(SceneKind::kBounce, time_s).position_mm;
    impacts.push_back({time_s, view.project(where, jump_mm_s, Vec3::Zero()).velocity_mm_s});
  };
  for (double t = kFirstFloor_s; t < kDuration_s; t += kFlight_s) {
    add(t, {0.0, -kGravity_mm_s2 * kFlight_s, 0.0});
  }
  add(kFirstWall_s, {-2.0 * kWallSpeed_mm_s, 0.0, 0.0});
  add(kFirstWall_s + 0.5 * kDuration_s, {2.0 * kWallSpeed_mm_s, 0.0, 0.0});
  std::sort(impacts.begin(), impacts.end(),
            [](const SceneImpact& a, const SceneImpact& b) { return a.time_s < b.time_s; });
  return impacts;
}

/// Returns the roots of a x^2 - 2 b x + c = 0 in ascending order; the quadric guarantees that they
/// are real.
Vec2 tangents(double a, double b, double c) {
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const Vec2 both((b - root) / a, (b + root) / a);
  return {both.minCoeff(), both.maxCoeff()};
}

}  // namespace

double SceneView::height_mm(double depth_mm) const noexcept {
  return (range.far_mm - depth_mm) / (range.far_mm - range.near_mm) * workspace.depth_mm;
}

Motion SceneView::project(const Vec3& p, const Vec3& v, const Vec3& a) const noexcept {
  // q = X/Z: q' = (X' - q Z')/Z, q'' = (X'' - q Z'' - 2 q' Z')/Z, and the same for Y/Z.
  const double z = p.z();
  const Vec2 q = p.head<2>() / z;
  const Vec2 q1 = (v.head<2>() - q * v.z()) / z;
  const Vec2 q2 = (a.head<2>() - q * a.z() - 2.0 * q1 * v.z()) / z;
  const Vec2 mm_per_px = workspace.mmPerPixel();
  const Vec2 scale(camera.fx_px * mm_per_px.x(), -camera.fy_px * mm_per_px.y());
  const double depth_scale = -workspace.depth_mm / (range.far_mm - range.near_mm);
  const Vec2 position = workspace.toNominal(camera.project(p));
  const Vec2 velocity = scale.cwiseProduct(q1);
  const Vec2 acceleration = scale.cwiseProduct(q2);
  Motion motion;
  motion.position_mm = {position.x(), position.y(), height_mm(z)};
  motion.velocity_mm_s = {velocity.x(), velocity.y(), depth_scale * v.z()};
  motion.acceleration_mm_s2 = {acceleration.x(), acceleration.y(), depth_scale * a.z()};
  return motion;
}

SceneInstant::SceneInstant(const SceneView& view, const BodyState& body, const Vec3& semi_axes_mm,
                           double angle_rad)
    : view_(view), body_(body), angle_rad_(angle_rad) {
  const Vec3 squares = semi_axes_mm.cwiseAbs2();
  const Eigen::Matrix3d& r = body.rotation;
  shape_ = r * squares.cwiseInverse().asDiagonal() * r.transpose();
  dual_ =
      r * squares.asDiagonal() * r.transpose() - body.position_mm * body.position_mm.transpose();
  shape_centre_ = shape_ * body.position_mm;
  centre_term_ = body.position_mm.dot(shape_centre_) - 1.0;
}

std::optional<SceneInstant::Hit> SceneInstant::hit(const Vec2& image_px) const noexcept {
  const Vec3 ray = view_.camera.ray(image_px.x(), image_px.y());
  const Vec3 shape_ray = shape_ * ray;
  const double a = ray.dot(shape_ray);
  const double b = ray.dot(shape_centre_);
  const double discriminant = b * b - a * centre_term_;
  if (!(discriminant > 0.0)) return std::nullopt;
  // The nearer root, in a form without cancellation.
  const double z = centre_term_ / (b + std::sqrt(discriminant));
  const Vec3 position = z * ray;
  return Hit{position, shape_ * position - shape_centre_};
}

std::optional<SurfaceSample> SceneInstant::surface(const Vec2& nominal_mm) const noexcept {
  const auto seen = hit(view_.workspace.toImage(nominal_mm));
  if (!seen) return std::nullopt;
  // X = z ray(u, v) stays on the surface: n . (dz ray + z dray) = 0.
  const double z = seen->position_mm.z();
  const Vec2 dray(1.0 / view_.camera.fx_px, 1.0 / view_.camera.fy_px);
  const Vec2 dz_dpx =
      -z * z / seen->normal.dot(seen->position_mm) * seen->normal.head<2>().cwiseProduct(dray);
  const Vec2 mm_per_px = view_.workspace.mmPerPixel();
  const double dh_dz = -view_.workspace.depth_mm / (view_.range.far_mm - view_.range.near_mm);
  return SurfaceSample{view_.height_mm(z),
                       {dh_dz * dz_dpx.x() / mm_per_px.x(), -dh_dz * dz_dpx.y() / mm_per_px.y()}};
}

Motion SceneInstant::motion() const noexcept {
  Motion motion = view_.project(body_.position_mm, body_.velocity_mm_s, body_.acceleration_mm_s2);
  motion.angle_rad = angle_rad_;
  motion.angular_velocity_rad_s = -body_.angular_velocity_rad_s.z();
  motion.reference_point = ReferencePoint::kCentreOfMass;
  return motion;
}

std::optional<Motion> SceneInstant::pointMotion(const Vec2& nominal_mm) const noexcept {
  const auto seen = hit(view_.workspace.toImage(nominal_mm));
  if (!seen) return std::nullopt;
  const Vec3& omega = body_.angular_velocity_rad_s;
  const Vec3 turning = omega.cross(seen->position_mm - body_.position_mm);
  Motion motion = view_.project(seen->position_mm, body_.velocity_mm_s + turning,
                                body_.acceleration_mm_s2 + omega.cross(turning));
  motion.angle_rad = angle_rad_;
  motion.angular_velocity_rad_s = -omega.z();
  return motion;
}

PixelRect SceneInstant::boundingBox() const noexcept {
  // The vertical line x = s touches the outline where dual00 - 2 s dual02 + s^2 dual22 = 0.
  const CameraModel& camera = view_.camera;
  const Vec2 u =
      camera.fx_px * tangents(dual_(2, 2), dual_(0, 2), dual_(0, 0)).array() + camera.cx_px;
  const Vec2 v =
      camera.fy_px * tangents(dual_(2, 2), dual_(1, 2), dual_(1, 1)).array() + camera.cy_px;
  const auto cut = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  const int u0 = cut(std::floor(u.x()), view_.workspace.width_px);
  const int v0 = cut(std::floor(v.x()), view_.workspace.height_px);
  const int u1 = cut(std::ceil(u.y()), view_.workspace.width_px);
  const int v1 = cut(std::ceil(v.y()), view_.workspace.height_px);
  return {u0, v0, u1 - u0, v1 - v0};
}

SyntheticScene::SyntheticScene(SceneKind kind, const Workspace& workspace)
    : kind_(kind),
      view_(makeView(kind, workspace)),
      semi_axes_mm_(kind == SceneKind::kTumble ? Vec3(80.0, 56.0, 64.0)
                                               : Vec3::Constant(kBallRadius_mm)) {
  if (kind == SceneKind::kBounce) impacts_ = bounces(view_);
}

SceneInstant SyntheticScene::at(double time_s) const {
  const BodyState body = computeBodyState(kind_, time_s);
  // Camera z points away from the viewer, nominal z towards the viewer; the angular velocity is
  // constant.
  return {view_, body, semi_axes_mm_, -body.angular_velocity_rad_s.z() * time_s};
}

double SyntheticScene::duration_s() const noexcept { return kDuration_s; }

double SyntheticScene::background_mm() const noexcept { return view_.range.far_mm + 300.0; }

}  // namespace hapticast::server
