// SPDX-License-Identifier: MIT
// The thesis's method freezes the contact between two frames, so a soft hand on a slope beats. The
// energy of the beats is bounded as that of any contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

constexpr double kBall_mm = 18.0;

struct Beats {
  int count = 0;
  double relative_mJ = 0.0;
};

/// A light hand presses on a still ball at (x, y) for 9 s. The method is the thesis's from
/// `from_s`.
Beats pressBall(double x_mm, double y_mm, double from_s) {
  static const auto ball = makeBall({0.0, 0.0, 10.0}, kBall_mm, 17.0, Workspace{});
  RendererSettings settings;
  settings.profile = loadDeviceProfile("omni");
  Attack attack(settings, 60.0);
  attack.hold(Hand::light());
  attack.scene = [&](PlayFrame& frame, double) {
    attack.add(frame, makeObject(1, ball.get(), {0.0, 0.0, 20.0}));
  };
  const DeviceMapping map = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
  const double pressed_mm = 7.5 + std::sqrt(kBall_mm * kBall_mm - x_mm * x_mm - y_mm * y_mm);
  attack.device->reset(map.toDevice({x_mm, y_mm, 60.0}), Vec3::Zero());
  Beats beats;
  bool high = false;
  double before_mJ = 0.0;
  for (int i = 0; i < 9000; ++i) {
    if (i == static_cast<int>(from_s * 1e3)) {
      attack.wishes.method = Method::kThesis;
      before_mJ = attack.renderer->report().work.relative_mJ;
    }
    const double z_mm = std::max(pressed_mm, 60.0 - std::max(0, i - 1000) * 0.05);
    attack.device->setTarget(map.toDevice({x_mm, y_mm, z_mm}));
    const double force_N = attack.step().force_N.norm();
    if (i < 3500) continue;
    if (force_N > 0.3 && !high) ++beats.count;
    high = force_N > 0.3 || (high && force_N > 0.05);
  }
  beats.relative_mJ = attack.renderer->report().work.relative_mJ - before_mJ;
  return beats;
}

TEST(ThesisContactSafety, DoesNotBeatOnASlope) {
  struct Place {
    double x_mm, y_mm;
  };
  for (const Place& at : {Place{0, 0}, {0, -8}, {0, -14}, {5, -14}, {-9, -8}, {-9, 8}}) {
    for (const double from_s : {0.0, 3.0}) {
      const Beats beats = pressBall(at.x_mm, at.y_mm, from_s);
      EXPECT_LE(beats.count, 3) << at.x_mm << ", " << at.y_mm << " from " << from_s << " s";
      EXPECT_LE(beats.relative_mJ, 15.0)
          << at.x_mm << ", " << at.y_mm << " from " << from_s << " s";
    }
  }
}

}  // namespace
}  // namespace hapticast::client
