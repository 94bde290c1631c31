// SPDX-License-Identifier: MIT
// The scenes themselves. Their names are those in the reports.
#include <Eigen/Geometry>
#include <cmath>

#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kTwoPi = 2.0 * CV_PI;

struct Swing {
  double middle = 0.0, amplitude = 0.0, rate_Hz = 0.0, phase_rad = 0.0;
};

struct Turn {
  Vec3 axis{0, 0, 1};
  double rate_rad_s = 0.0;
};

Path swinging(const Swing& x, const Swing& y, const Swing& z, const Turn& turn = {}) {
  return [=](double t) {
    server::BodyState body;
    const Swing* axes[] = {&x, &y, &z};
    for (int i = 0; i < 3; ++i) {
      const double omega = kTwoPi * axes[i]->rate_Hz;
      const double angle = omega * t + axes[i]->phase_rad;
      body.position_mm[i] = axes[i]->middle + axes[i]->amplitude * std::sin(angle);
      body.velocity_mm_s[i] = axes[i]->amplitude * omega * std::cos(angle);
      body.acceleration_mm_s2[i] = -axes[i]->amplitude * omega * omega * std::sin(angle);
    }
    const Vec3 axis = turn.axis.normalized();
    body.rotation = Eigen::AngleAxisd(turn.rate_rad_s * t, axis).toRotationMatrix();
    body.angular_velocity_rad_s = turn.rate_rad_s * axis;
    return body;
  };
}

// Under gravity (picture plane) to a floor and back, elastic, with a steady drift in x.
constexpr double kFall_mm = 460.0;
constexpr double kFloor_mm = 280.0;
double flightTime_s(double gravity_mm_s2) {
  return 2.0 * std::sqrt(2.0 * kFall_mm / gravity_mm_s2);
}

Path bouncing(double gravity_mm_s2, double first_s) {
  return [=](double t) {
    const double period = flightTime_s(gravity_mm_s2);
    const double s = t - first_s - period * std::floor((t - first_s) / period);
    const double up = 0.5 * gravity_mm_s2 * period;
    server::BodyState body;
    body.position_mm = {-150.0 + 100.0 * t, kFloor_mm - up * s + 0.5 * gravity_mm_s2 * s * s,
                        1000.0};
    body.velocity_mm_s = {100.0, -up + gravity_mm_s2 * s, 0.0};
    body.acceleration_mm_s2 = {0.0, gravity_mm_s2, 0.0};
    return body;
  };
}

TestScene ballScene(std::string name, Path path) {
  TestScene scene;
  scene.name = std::move(name);
  scene.bodies = {{Shape::kEllipsoid, Vec3::Constant(100.0), std::move(path)}};
  return scene;
}

TestScene bounceScene(std::string name, double gravity_mm_s2, double first_s) {
  TestScene scene = ballScene(std::move(name), bouncing(gravity_mm_s2, first_s));
  for (double t = first_s; t < scene.duration_s; t += flightTime_s(gravity_mm_s2))
    scene.impacts_s.push_back(t);
  return scene;
}

const Turn kTurn{{0.5, 0.7, -0.5}, 2.4};

Path generalPath(const Turn& turn) {
  return swinging({0, 200, 0.7, 0.0}, {0, 120, 1.0, 0.7}, {1000, 80, 0.8, 1.0}, turn);
}

Body bar() {
  Body out;
  out.shape = Shape::kBox;
  out.half_size_mm = {25, 600, 5};
  out.is_object = false;
  out.dark = {40, 90, 40};
  out.light = {90, 170, 90};
  out.path = swinging({0, 0, 0}, {0, 0, 0}, {720, 0, 0});
  return out;
}

}  // namespace

// The analyzer does not see that std::function frees what it holds.
// NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks)
std::vector<TestScene> motionScenes() {
  std::vector<TestScene> out;
  out.push_back(bounceScene("bounce_slow", 1000.0, 0.51));
  out.push_back(bounceScene("bounce_real", 9810.0, 0.31));
  out.push_back(ballScene("zsin", swinging({}, {}, {1000, 120, 1.0, 0.3})));
  out.push_back(ballScene("general", generalPath(kTurn)));
  out.push_back(ballScene("planar", swinging({0, 200, 0.7, 0.0}, {0, 120, 1.0, 0.7}, {1000})));
  out.push_back(ballScene("rotonly", swinging({}, {}, {1000}, kTurn)));
  out.push_back(ballScene("static", swinging({}, {}, {1000})));
  out.push_back(ballScene("fast40", swinging({0, 400, 0.663, 0.0}, {0, 40, 0.5, 0.4}, {1000})));
  out.push_back(out.back());
  out.back().name = "fast40blur";
  out.back().blur = true;
  out.push_back(ballScene("textureless", generalPath({})));
  out.back().bodies[0].textured = false;
  out.push_back(
      ballScene("occl", swinging({0, 220, 0.5, -1.2}, {0, 60, 0.7, 0.7}, {1000, 40, 0.6, 1.0})));
  out.back().bodies.push_back(bar());
  out.push_back(ballScene("pan", generalPath(kTurn)));
  out.back().pan_px = 60.0;
  out.back().pan_hz = 0.5;
  out.push_back(
      ballScene("leave", swinging({0, 480, 0.3, 0.0}, {0, 80, 0.6, 0.7}, {1000, 60, 0.5, 1.0})));
  out.push_back(ballScene("touch", generalPath(kTurn)));
  Body hand;
  hand.is_object = false;
  hand.half_size_mm = {45, 45, 160};
  hand.dark = {90, 110, 160};
  hand.light = {150, 170, 220};
  hand.path = [path = generalPath({{0, 0, 1}, 0.0})](double t) {
    server::BodyState body = path(t);
    body.position_mm += Vec3(70, 70, -60);
    return body;
  };
  out.back().bodies.push_back(hand);
  out.push_back(ballScene("ellipsoid", generalPath(kTurn)));
  out.back().bodies[0].half_size_mm = {120, 66, 96};
  out.push_back(ballScene("box", generalPath({{0.4, 0.8, -0.3}, 1.5})));
  out.back().bodies[0].shape = Shape::kBox;
  out.back().bodies[0].half_size_mm = {90, 60, 70};
  return out;
}

std::vector<TestScene> segmentationScenes() {
  const double c = std::cos(35.0 * CV_PI / 180.0);
  const double s = std::sin(35.0 * CV_PI / 180.0);
  const Vec3 along(0, s, -c);  // on the table, towards the viewer and down the picture
  const Vec3 up(0, -c, -s);
  const Vec3 middle(0, 0, 1000);
  const auto onTable = [=](double height_mm, const Swing& x, const Swing& to_viewer,
                           const Turn& turn) {
    const Path flat = swinging(x, to_viewer, {}, turn);
    return [=](double t) {
      server::BodyState body = flat(t);
      const Vec3 p = body.position_mm;
      const Vec3 v = body.velocity_mm_s;
      const Vec3 a = body.acceleration_mm_s2;
      body.position_mm = middle + height_mm * up + Vec3(p.x(), 0, 0) + p.y() * along;
      body.velocity_mm_s = Vec3(v.x(), 0, 0) + v.y() * along;
      body.acceleration_mm_s2 = Vec3(a.x(), 0, 0) + a.y() * along;
      return body;
    };
  };
  // A box stands with its faces along the table.
  const auto standing = [](const Path& path) {
    const Eigen::Matrix3d tilt =
        Eigen::AngleAxisd(35.0 * CV_PI / 180.0, Vec3::UnitX()).toRotationMatrix();
    return [=](double t) {
      server::BodyState body = path(t);
      body.rotation = body.rotation * tilt;
      return body;
    };
  };
  const auto scene = [](std::string name, Body body, bool table) {
    TestScene out;
    out.name = std::move(name);
    out.bodies = {std::move(body)};
    out.duration_s = 1.6;
    out.table = table;
    // What the picture holds, as who records in 8 bits would choose it.
    out.range = table ? server::DepthRange{500.0, 1900.0} : server::DepthRange{600.0, 1490.0};
    return out;
  };
  std::vector<TestScene> out;
  const Turn roll{{0, 0, 1}, 1.0};
  out.push_back(scene("ball_air",
                      {Shape::kEllipsoid, Vec3::Constant(90),
                       swinging({0, 150, 0.5}, {0, 60, 0.7}, {900, 60, 0.6}, kTurn)},
                      false));
  out.push_back(scene("tumble",
                      {Shape::kEllipsoid,
                       {110, 65, 85},
                       swinging({0, 120, 0.4}, {0, 50, 0.6}, {900, 60, 0.5}, kTurn)},
                      false));
  out.push_back(
      scene("ball_table",
            {Shape::kEllipsoid, Vec3::Constant(70), onTable(70, {0, 150, 0.4}, {0, 60, 0.5}, roll)},
            true));
  out.push_back(out.back());
  out.back().name = "ball_same";
  out.back().same_colors = true;
  out.push_back(scene(
      "box_table",
      {Shape::kBox, {90, 60, 60}, standing(onTable(61, {0, 60, 0.3}, {0, 30, 0.4}, {up, 0.8}))},
      true));
  {
    TestScene creature = scene(
        "creature", {Shape::kEllipsoid, {100, 60, 70}, onTable(85, {0, 40, 0.3}, {0, 20, 0.4}, {})},
        true);
    Body head{Shape::kEllipsoid, Vec3::Constant(42), {}};
    head.path = [body = creature.bodies[0].path](double t) {
      server::BodyState at = body(t);
      at.position_mm += Vec3(95, -70 + 15 * std::sin(kTwoPi * 0.9 * t), -20);
      return at;
    };
    creature.bodies.push_back(head);
    for (const double x : {-60.0, 60.0}) {
      Body foot{Shape::kEllipsoid, {26, 40, 26}, {}};
      foot.path = [body = creature.bodies[0].path, x, up](double t) {
        server::BodyState at = body(t);
        at.position_mm += Vec3(x, 0, 0) - 55.0 * up;
        return at;
      };
      creature.bodies.push_back(foot);
    }
    out.push_back(creature);
  }
  {
    TestScene touch = scene(
        "hand_touch",
        {Shape::kEllipsoid, Vec3::Constant(75), onTable(75, {0, 60, 0.4, -1.5}, {0, 0, 0}, roll)},
        true);
    Body arm{Shape::kEllipsoid, {220, 38, 38}, {}};
    arm.is_object = false;
    arm.dark = {90, 110, 160};
    arm.light = {150, 170, 220};
    arm.path = [ball = touch.bodies[0].path](double t) {
      server::BodyState at = ball(t);
      at.position_mm += Vec3(-290.0 - 60.0 * std::max(0.0, 0.5 - t), -20, 0);
      return at;
    };
    touch.bodies.push_back(arm);
    out.push_back(touch);
  }
  {
    TestScene crossed = scene("occluder",
                              {Shape::kEllipsoid, Vec3::Constant(90),
                               swinging({0, 60, 0.4}, {0, 30, 0.5}, {1000, 30, 0.4}, kTurn)},
                              false);
    Body across = bar();
    across.path = swinging({0, 300, 0.3, -1.5}, {0, 0, 0}, {720, 0, 0});
    crossed.bodies.push_back(across);
    out.push_back(crossed);
  }
  out.push_back(
      scene("still", {Shape::kEllipsoid, Vec3::Constant(75), onTable(75, {}, {}, {})}, true));
  return out;
}
// NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)

}  // namespace hapticast::evaluate
