// SPDX-License-Identifier: MIT
#include "tests/scenes/relief_scenes.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMmPerPx = 0.25;
constexpr double kLong_s = 40.0;

HeightAt ellipsoid(double a, double b, double c) {
  return [=](const Vec2& q, double) {
    const double rest = 1.0 - q.x() * q.x() / (a * a) - q.y() * q.y() / (b * b);
    return rest > 0.0 ? c * std::sqrt(rest) : kNone;
  };
}

MotionAt standing(const Vec3& at_mm, double angle_rad = 0.0) {
  return [=](double) {
    Motion motion;
    motion.position_mm = at_mm;
    motion.angle_rad = angle_rad;
    motion.reference_point = ReferencePoint::kCentreOfMass;
    return motion;
  };
}

/// at + amplitude sin(omega t + phase) in one direction.
MotionAt swingingAbout(const Vec3& at_mm, const Vec3& amplitude_mm, double omega,
                       double phase = 0.0) {
  return [=](double t) {
    Motion motion = standing(at_mm)(t);
    const double angle = omega * t + phase;
    motion.position_mm += std::sin(angle) * amplitude_mm;
    motion.velocity_mm_s = omega * std::cos(angle) * amplitude_mm;
    motion.acceleration_mm_s2 = -omega * omega * std::sin(angle) * amplitude_mm;
    return motion;
  };
}

ReliefBody still(std::string name, HeightAt height_mm, const Vec3& at_mm, double reach_mm) {
  return {std::move(name), std::move(height_mm), reach_mm, kLong_s, standing(at_mm), true};
}

// A little beside the picture's centre, so that no pixel's centre is a special place.
const Vec3 kHere(1.37, -0.81, 2.3);
const Vec3 kOnTable(1.37, -0.81, 0.0);

}  // namespace

TouchScene stillSphere() { return reliefScene(still("sphere", ellipsoid(20, 20, 20), kHere, 21)); }

TouchScene stillEllipsoid() {
  return reliefScene(still("ellipsoid", ellipsoid(26, 18, 15), kHere, 27));
}

TouchScene stillSinusoid() {
  const HeightAt height = [](const Vec2& q, double) {
    return q.norm() < 25.0
               ? 10.0 + std::sin(2.0 * std::numbers::pi * (q.x() + 0.3 * q.y()) / 16.0 / 1.044)
               : kNone;
  };
  return reliefScene(still("sinusoid", height, kHere, 26));
}

TouchScene movingSphere(double px_per_frame, double duration_s) {
  const double fastest_mm_s = px_per_frame * kMmPerPx * kSceneFps;
  const double amplitude_mm = std::min(60.0, 1.6 * fastest_mm_s);
  ReliefBody body{"sphere, " + std::to_string(int(px_per_frame)) + " px/frame",
                  ellipsoid(15, 15, 15), 16.0, duration_s,
                  swingingAbout(kHere, {amplitude_mm, 0, 0}, fastest_mm_s / amplitude_mm)};
  return reliefScene(body);
}

TouchScene swingingSphere(const Vec3& amplitude_mm, double rate_Hz) {
  ReliefBody body{"swinging sphere", ellipsoid(20, 20, 20), 21.0, 8.0,
                  swingingAbout(kHere + Vec3(0, 0, std::abs(amplitude_mm.z())), amplitude_mm,
                                2.0 * std::numbers::pi * rate_Hz)};
  return reliefScene(body);
}

TouchScene spinningEllipsoid(double duration_s) {
  ReliefBody body{"turning ellipsoid", ellipsoid(26, 18, 15), 27.0, duration_s, [](double t) {
                    constexpr double kRate_rad_s = 1.7;
                    Motion motion = standing(kHere, kRate_rad_s * t)(t);
                    motion.angular_velocity_rad_s = kRate_rad_s;
                    return motion;
                  }};
  return reliefScene(body);
}

TouchScene steadySphere(double px_per_frame) {
  const double speed_mm_s = px_per_frame * kMmPerPx * kSceneFps;
  const double duration_s = 110.0 / speed_mm_s;
  ReliefBody body{"steady sphere", ellipsoid(20, 20, 20), 21.0, duration_s, [=](double t) {
                    Motion motion = standing({-55.0 + speed_mm_s * t, -0.81, 2.3})(t);
                    motion.velocity_mm_s.x() = speed_mm_s;
                    return motion;
                  }};
  return reliefScene(body);
}

namespace {
HeightAt disc(double radius_mm) {
  return [=](const Vec2& q, double) { return q.norm() < radius_mm ? 0.0 : kNone; };
}
}  // namespace

TouchScene swingingPlate(double duration_s) {
  ReliefBody body{"rising plate", disc(25), 26.0, duration_s,
                  swingingAbout({1.37, -0.81, 13.3}, {0, 0, 5}, 2.0 * std::numbers::pi)};
  return reliefScene(body);
}

TouchScene breathingDome(double duration_s) {
  const HeightAt height = [](const Vec2& q, double t) {
    const double rest = 1.0 - q.squaredNorm() / 625.0;
    return rest > 0.0 ? 8.0 + (8.0 + 2.0 * std::sin(2.0 * std::numbers::pi * t)) * rest : kNone;
  };
  return reliefScene({"deforming dome", height, 26.0, duration_s, standing(kHere)});
}

TouchScene stillPlate() { return reliefScene(still("plate", disc(30), {1.37, -0.81, 14.1}, 31)); }

namespace {
constexpr double kTurn_rad = 17.0 * std::numbers::pi / 180.0;
const Vec2 kBoxHalf_mm(22.0, 15.0);

HeightAt box(double slope) {
  return [=](const Vec2& q, double) {
    return std::abs(q.x()) < kBoxHalf_mm.x() && std::abs(q.y()) < kBoxHalf_mm.y()
               ? 17.4 + slope * (kBoxHalf_mm.x() - q.x())
               : kNone;
  };
}
}  // namespace

TouchScene drivenBox() {
  // The right side reaches 2 mm beyond x = 30, at sqrt(20² - 18²) omega.
  constexpr double kAmplitude_mm = 20.0;
  const double omega = 10.0 * kMmPerPx * kSceneFps / std::sqrt(20.0 * 20.0 - 18.0 * 18.0);
  ReliefBody body{"driven box", box(0.0), 28.0, 6.0,
                  swingingAbout({30.0 + 2.0 - kAmplitude_mm - kBoxHalf_mm.x(), -0.81, 0.0},
                                {kAmplitude_mm, 0, 0}, omega, -0.5 * std::numbers::pi)};
  return reliefScene(body);
}

TouchScene bouncingBall(double gravity_mm_s2, double flight_s, double first_s) {
  ReliefBody body{"bouncing ball", ellipsoid(15, 15, 15), 16.0, 6.0, [=](double t) {
                    Motion motion = standing(kHere)(t);
                    const double since =
                        t - first_s - flight_s * std::floor((t - first_s) / flight_s);
                    const double up = 0.5 * gravity_mm_s2 * flight_s;
                    motion.position_mm.y() += up * since - 0.5 * gravity_mm_s2 * since * since;
                    motion.velocity_mm_s.y() = up - gravity_mm_s2 * since;
                    motion.acceleration_mm_s2.y() = -gravity_mm_s2;
                    return motion;
                  }};
  return reliefScene(body);
}

std::vector<double> impactsOf(double flight_s, double first_s, double duration_s) {
  std::vector<double> out;
  for (double t = first_s; t < duration_s; t += flight_s) out.push_back(t);
  return out;
}

TouchScene syntheticScene(server::SceneKind kind) {
  const auto scene = std::make_shared<const server::SyntheticScene>(kind);
  TestScene test;
  for (const server::SceneName& entry : server::kSceneNames) {
    if (entry.kind == kind) test.name = entry.name;
  }
  test.bodies = {
      {Shape::kEllipsoid, scene->semiAxes_mm(), [scene](double t) { return scene->at(t).body(); }}};
  test.duration_s = scene->duration_s();
  test.range = scene->view().range;
  TouchScene out;
  out.name = test.name;
  out.duration_s = test.duration_s;
  out.height_mm = [scene](const Vec2& at_mm, double t) {
    const auto sample = scene->at(t).surface(at_mm);
    return sample ? sample->height_mm : kNone;
  };
  out.motion = [scene](double t) { return scene->at(t).motion(); };
  out.open = [test](const Seen& seen) {
    Sensor sensor;
    sensor.depth = seen.eight_bit ? Sensor::Depth::kEightBit : Sensor::Depth::kExact;
    return std::make_unique<TestSource>(test, sensor, kSceneFps, seen.give_mask);
  };
  return out;
}

// --- walls
// ----------------------------------------------------------------------------------------

Wall boxWall(double top_slope) {
  Wall wall;
  ReliefBody body = still(top_slope == 0.0 ? "box" : "sloped box", box(top_slope), kOnTable, 28);
  body.motion = standing(kOnTable, kTurn_rad);
  body.duration_s = 6.0;
  wall.scene = reliefScene(body);
  const Motion motion = body.motion(0.0);
  wall.at = [=](double along_mm) {
    return Wall::Point{
        motion.position_mm.head<2>() + turned({kBoxHalf_mm.x(), along_mm}, kTurn_rad),
        turned({1, 0}, kTurn_rad)};
  };
  wall.push_z_mm = 10.0;
  wall.top_mm = [=](const Vec2& at_mm, double) {
    const Vec2 q = turned(at_mm - motion.position_mm.head<2>(), -kTurn_rad);
    return 17.4 + top_slope * (kBoxHalf_mm.x() - q.x());
  };
  return wall;
}

Wall cylinderWall() {
  static constexpr double kRadius_mm = 15.0;
  Wall wall;
  ReliefBody body = still("cylinder", disc(kRadius_mm), {1.37, -0.81, 17.4}, 16);
  body.duration_s = 8.0;
  wall.scene = reliefScene(body);
  wall.at = [](double along_mm) {
    const Vec2 outward = turned({1, 0}, along_mm / kRadius_mm);
    return Wall::Point{kOnTable.head<2>() + kRadius_mm * outward, outward};
  };
  wall.push_z_mm = 10.0;
  wall.reach_mm = 23.5;  // half way round
  wall.top_mm = [](const Vec2&, double) { return 17.4; };
  return wall;
}

Wall stepWall() {
  Wall wall;
  const HeightAt step = [](const Vec2& q, double) {
    if (std::abs(q.x()) > 28.0 || std::abs(q.y()) > 18.0) return kNone;
    return q.x() < 0.0 ? 17.4 : 7.4;
  };
  ReliefBody body = still("10 mm step", step, kOnTable, 34);
  body.motion = standing(kOnTable, kTurn_rad);
  body.duration_s = 6.0;
  wall.scene = reliefScene(body);
  wall.at = [](double along_mm) {
    return Wall::Point{kOnTable.head<2>() + turned({0, along_mm}, kTurn_rad),
                       turned({1, 0}, kTurn_rad)};
  };
  wall.push_z_mm = 12.0;
  wall.top_mm = [](const Vec2&, double) { return 17.4; };
  return wall;
}

}  // namespace hapticast::evaluate
