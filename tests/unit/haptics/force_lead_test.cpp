// SPDX-License-Identifier: MIT
// How far the force over a moving surface runs ahead of play time: a plate heaves under a nailed
// HIP.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "client/haptics/safety/wall_law.hpp"
#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

constexpr double kOmega_rad_s = 2.0 * std::numbers::pi;  // one period is 25 frames
constexpr double kHeave_mm = 2.0;
constexpr double kStiffness_N_mm = 0.5;

/// Fits a sine of the plate's period to values over play time.
struct SineFit {
  double sine = 0.0;
  double cosine = 0.0;
  void add(double play_s, double value) {
    sine += value * std::sin(kOmega_rad_s * play_s);
    cosine += value * std::cos(kOmega_rad_s * play_s);
  }
  /// Returns the time by which the values run ahead of the plate's height.
  [[nodiscard]] double lead_ms() const { return std::atan2(cosine, sine) / kOmega_rad_s * 1e3; }
};

struct Leads {
  SineFit sent;
  SineFit contact;  ///< static force
  SineFit surface;  ///< height of the touched point
};

RendererSettings heavedDevice(int delay_ticks) {
  RendererSettings settings;
  settings.profile.delay_ticks = delay_ticks;
  settings.profile.continuous_N = settings.profile.peak_N;  // no limit by heat
  settings.stiffness_N_mm = kStiffness_N_mm;
  return settings;
}

Leads measureLeads(int delay_ticks) {
  Attack attack(heavedDevice(delay_ticks), 8.0);
  attack.name = "a heaving plate";
  attack.scene = [&](PlayFrame& frame, double time_s) {
    const double angle_rad = kOmega_rad_s * std::round(25.0 * std::fmod(time_s, 1.0)) / 25.0;
    attack.add(frame, plateAt(10.5 + kHeave_mm * std::sin(angle_rad)));
    Motion& motion = frame.objects[0].motion;
    motion.velocity_mm_s.z() = kHeave_mm * kOmega_rad_s * std::cos(angle_rad);
    motion.acceleration_mm_s2.z() = -kHeave_mm * kOmega_rad_s * kOmega_rad_s * std::sin(angle_rad);
  };
  (void)attack.run(3000);
  Leads leads;
  for (int i = 0; i < 4000; ++i) {
    const TickReport& report = attack.step();
    const double play_s = toSeconds(report.play_time.time_since_epoch());
    leads.sent.add(play_s, report.force_N.z());
    leads.contact.add(play_s, report.static_force_N.z());
    leads.surface.add(play_s, report.contact_mm.z());
  }
  return leads;
}

// client/haptics/playback/README.md: the shares of the lead.
TEST(ForceLead, IsThatOfTheSceneAndOfTheDamper) {
  for (int delay_ticks = 0; delay_ticks <= 2; ++delay_ticks) {
    const Leads leads = measureLeads(delay_ticks);
    const DeviceProfile profile = heavedDevice(delay_ticks).profile;
    const double damper_ms =
        wallDamping_Ns_m(kStiffness_N_mm, profile.mass_kg, stiffnessLimit_N_mm(profile)) /
        kStiffness_N_mm;
    const double scene_ms = delay_ticks + kPredictionMargin_ticks;
    EXPECT_NEAR(leads.surface.lead_ms(), scene_ms, 0.01);
    // The observer moves a nailed HIP by a fifth of a count.
    const double observer_ms = leads.contact.lead_ms() - scene_ms - damper_ms;
    EXPECT_LT(observer_ms, 0.0);
    EXPECT_GT(observer_ms, -1.3);
    EXPECT_NEAR(leads.sent.lead_ms(), leads.contact.lead_ms(), 0.3);
  }
}

}  // namespace
}  // namespace hapticast::client
