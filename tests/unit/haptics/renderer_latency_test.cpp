// SPDX-License-Identifier: MIT
// A device slower than its profile says, through the whole renderer; the author's damping and the
// work in the report.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

RendererSettings makeStiffRenderer() {
  RendererSettings renderer;
  renderer.profile.peak_N = renderer.profile.continuous_N = 8.0;
  renderer.stiffness_N_mm = 5.0;
  return renderer;
}

/// A hand on a still plate with a device that takes `ticks` longer than the renderer's profile.
struct SlowDevice {
  explicit SlowDevice(int ticks) : attack(makeStiffRenderer()) {
    attack.name = "a slow device";
    attack.scene = [this](PlayFrame& frame, double) { attack.add(frame, plateAt(8.0)); };
    PlantProfile real{attack.settings.profile};
    real.delay_ticks += ticks;
    attack.device.emplace(real, Hand::lightGrip(), attack.clock);
    target(20.0);
    attack.device->reset(target_mm, Vec3::Zero());
    run(500);
    target(2.0);
  }
  void target(double nominal_mm) {
    target_mm = DeviceMapping::fit(Workspace{}, attack.settings.profile.workspace_mm)
                    .toDevice({0.1, 0.1, nominal_mm});
    attack.device->setTarget(target_mm);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const TickReport& report = attack.step();
      faults += report.fault == Fault::kLatency;
      softened += (report.safety_actions & bit(SafetyAction::kLatency)) != 0;
    }
  }
  Attack attack;
  Vec3 target_mm = Vec3::Zero();
  int faults = 0;
  int softened = 0;
};

TEST(RendererLatency, ADeviceSlowerThanItsProfileIsAFaultOnceAConnection) {
  SlowDevice exact(0);
  exact.run(3000);
  EXPECT_EQ(exact.faults, 0);
  EXPECT_EQ(exact.softened, 0);

  SlowDevice slow(2);
  slow.run(3000);
  EXPECT_EQ(slow.faults, 1);
  EXPECT_GT(slow.softened, 500);
  EXPECT_TRUE(slow.attack.renderer->recorder().frozen());
}

TEST(RendererLatency, ANewConnectionTrustsTheProfileAgain) {
  SlowDevice slow(2);
  slow.run(3000);
  slow.target(20.0);
  slow.run(500);
  slow.attack.control.connected = false;
  slow.run(10);
  slow.attack.control.connected = true;
  slow.run(10);
  slow.softened = 0;
  slow.target(6.0);
  slow.run(60);
  EXPECT_GT(slow.attack.renderer->report().force_N.norm(), 0.1);
  EXPECT_EQ(slow.softened, 0);
}

TEST(RendererLatencyWork, ARisingPlatePushesAtTheSurfacesPort) {
  Attack attack{RendererSettings{}};
  attack.name = "a plate to and fro";
  attack.scene = [&](PlayFrame& frame, double time_s) {
    const double height_mm = 9.0 + std::round(100.0 * std::sin(6.0 * time_s)) * 0.01;
    attack.add(frame, plateAt(height_mm));
    frame.objects[0].motion.velocity_mm_s.z() = 6.0 * std::cos(6.0 * time_s);
  };
  attack.hold(Hand::light());
  const Vec3 target_mm = DeviceMapping::fit(Workspace{}, attack.settings.profile.workspace_mm)
                             .toDevice({0.1, 0.1, 4.0});
  attack.device->reset(target_mm + Vec3(0.0, 0.0, 10.0), Vec3::Zero());
  (void)attack.run(500);
  attack.device->setTarget(target_mm);
  (void)attack.run(1500);
  const PortWork before = attack.renderer->report().work;
  const PortWork after = attack.run(4000).work;
  EXPECT_GT(std::abs(after.surface_mJ - before.surface_mJ), 0.3);
  EXPECT_LT(after.relative_mJ - before.relative_mJ, 1.0);
  EXPECT_NEAR(after.object_mJ, before.object_mJ, 0.1);  // the hand's own inertia only
}

TEST(RendererLatencyWork, TheAuthorsDampingReachesTheWall) {
  double mean_N[2] = {0.0, 0.0};
  for (const bool damped : {false, true}) {
    Attack attack{RendererSettings{}, 14.0};
    attack.name = "a damped plate";
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0));
      frame.objects[0].material.damping_Ns_m = damped ? 3.0 : 0.0;
    };
    attack.hold(Hand::firm());
    const DeviceMapping mapping =
        DeviceMapping::fit(Workspace{}, attack.settings.profile.workspace_mm);
    attack.device->reset(mapping.toDevice({0.1, 0.1, 20.0}), Vec3::Zero());
    (void)attack.run(500);
    for (int i = 0; i < 200; ++i) {  // into the plate at 60 mm/s
      attack.device->setTarget(mapping.toDevice({0.1, 0.1, 20.0 - 0.06 * i}));
      mean_N[damped ? 1 : 0] += attack.step().force_N.z() / 200.0;
    }
  }
  EXPECT_GT(mean_N[1], 1.02 * mean_N[0]);
}

}  // namespace
}  // namespace hapticast::client
