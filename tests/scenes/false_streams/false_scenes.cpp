// SPDX-License-Identifier: MIT
// False streams with a wrong scene: geometry, motion, material.
#include <array>
#include <cmath>

#include "tests/scenes/false_streams/false_stream_parts.hpp"

namespace hapticast::testing {

// --- geometry

FalseStreams geometry() {
  return {
      {"spikes", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.setRelief(
             shape([&](double, double) { return t.between(0.0, 1.0) < 0.02 ? 30.0 : 10.0; }));
       }},
      {"strobe_2mm", kHold, kHarmless,
       [](OutgoingFrame& t) { moveTo(t, t.n % 2 == 0 ? 10.0 : 12.0); }},
      {"strobe_20mm", kHold, kLimited,
       [](OutgoingFrame& t) { moveTo(t, t.n % 2 == 0 ? 5.0 : 25.0); }},
      {"strobe_20mm_new_ids", kHold, kHarmless,
       [](OutgoingFrame& t) {
         moveTo(t, t.n % 2 == 0 ? 5.0 : 25.0);
         t.object().id = static_cast<std::uint32_t>(t.n);
       }},
      {"surface_30mm_above", kShallow, kLimited,
       [](OutgoingFrame& t) { moveTo(t, t.n % 50 < 25 ? 10.0 : 30.0); }},
      {"to_and_fro_40px", kHold, kHarmless,
       [](OutgoingFrame& t) {
         const int side = t.n % 2 == 0 ? 40 : -40;
         t.setRelief(plate(10.0, side));
         t.motion().position_mm.x() = 0.25 * side;
       }},
      {"side_sweep_box", kBeside, kHarmless,
       [](OutgoingFrame& t) {
         const double x_mm = 12.0 * wave(t.t_s, 1.5);
         t.setRelief(plate(20.0, static_cast<int>(std::lround(4.0 * x_mm))));
         t.motion().position_mm = {x_mm, 0.0, 20.0};
         t.motion().velocity_mm_s.x() =
             12.0 * 2.0 * std::numbers::pi * 1.5 * wave(t.t_s, 1.5, std::numbers::pi / 2.0);
       }},
      {"oscillate_2hz", kHold, kHarmless, heave(2.0, 5.0)},
      {"oscillate_5hz", kHold, kLimited, heave(5.0, 4.0)},
      {"oscillate_8hz", kHold, kLimited, heave(8.0, 4.0)},
      {"oscillate_12hz", kHold, kLimited, heave(12.0, 4.0)},
      {"oscillate_12hz_press", kPress, kLimited, heave(12.0, 4.0)},
      {"ratchet", kHold, kHarmless,
       [](OutgoingFrame& t) {
         const double rise = std::fmod(t.t_s * 5.0, 1.0);
         moveTo(t, 8.0 + 6.0 * rise, 30.0);
       }},
      {"travelling_wave", kHold, kLimited,
       [](OutgoingFrame& t) {
         t.setRelief(shape([&](double x, double) { return 10.0 + 3.0 * wave(t.t_s + x, 3.0); }));
       }},
      {"tilting_plate", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.setRelief(shape([&](double x, double y) {
           return 10.0 + 5.0 * (x * wave(t.t_s, 4.0) + y * wave(t.t_s, 4.0, 1.57));
         }));
       }},
      {"checkerboard", kHold, kHarmless,
       [](OutgoingFrame& t) {
         auto relief = flatRelief(kPlateau_px, 12.0F);
         for (std::size_t i = 0; i < relief->mask.size(); ++i) {
           const std::size_t side = static_cast<std::size_t>(kPlateau_px.width);
           relief->mask[i] = static_cast<std::uint8_t>((i % side / 4 + i / side / 4 + t.n) % 2);
         }
         t.setRelief(relief);
       }},
      {"overlapping_turns", kHold, kLimited,
       [](OutgoingFrame& t) {
         for (std::uint32_t i = 2; i < 6; ++i) {
           HapticObject more = t.object();
           more.id = i;
           more.relief = plate((t.n + i) % 4 == 0 ? 14.0 : 6.0);
           more.changed_in_frame = t.frame.id;
           t.frame.objects.push_back(more);
         }
       }},
      {"heights_of_noise", kHold, kLimited,
       [](OutgoingFrame& t) {
         t.setRelief(shape([&](double, double) { return t.between(5.0, 15.0); }));
       }},
      {"random_heights", kHold, kTrustLost,
       [](OutgoingFrame& t) { moveTo(t, t.between(2.0, 20.0), t.between(-500.0, 500.0)); }},
      {"relief_without_motion", kHold, kLimited,
       [](OutgoingFrame& t) { t.setRelief(plate(10.0 + 4.0 * wave(t.t_s, 5.0))); }},
      {"motion_without_relief", kHold, kLimited,
       [](OutgoingFrame& t) { t.motion().position_mm.z() = 10.0 + 4.0 * wave(t.t_s, 5.0); }},
      {"workspace_flips", kHold, kLimited,
       [](OutgoingFrame& t) {
         if (t.n % 10 != 0) return;
         t.description.emplace();
         t.description->workspace.width_mm = t.n % 20 == 0 ? 160.0 : 320.0;
         t.description->workspace.height_mm = t.n % 20 == 0 ? 120.0 : 240.0;
       }},
  };
}

namespace {

// --- motion that the positions do not bear out

auto accelerate(double hz, int axis, double amplitude_mm_s2) {
  return [=](OutgoingFrame& t) {
    t.motion().acceleration_mm_s2[axis] = amplitude_mm_s2 * square(t.t_s, hz);
  };
}
void announceAll(StreamDescription& description) { description.largest_acceleration_mm_s2 = 1e8; }
void announceSmall(StreamDescription& description) {
  description.largest_acceleration_mm_s2 = 1.0;
  description.mass_kg = 1000.0;
}

}  // namespace

FalseStreams motion() {
  return {
      {"acceleration_1e8", kHold, kTrustLost,
       [](OutgoingFrame& t) { t.motion().acceleration_mm_s2.z() = 1e8; }},
      {"acceleration_1e8_described", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         t.motion().acceleration_mm_s2 = {1e8 * square(t.t_s, 4.0), 0.0, 0.0};
       },
       announceAll},
      {"acceleration_1e8_z_described", kHold, kTrustLost, accelerate(4.0, 2, 1e8), announceAll},
      {"acc_square_4hz_x", kShallow, kTrustLost, accelerate(4.0, 0, 1e5)},
      {"acc_square_8hz_x", kShallow, kTrustLost, accelerate(8.0, 0, 1e5)},
      {"acc_square_16hz_x", kShallow, kTrustLost, accelerate(12.5, 0, 1e5)},
      {"acc_square_4hz_z", kHold, kTrustLost, accelerate(4.0, 2, 1e5)},
      {"acc_square_2hz_y_heavy", kHold, kTrustLost, accelerate(2.0, 1, 1e4), announceSmall},
      {"acc_small_4hz_x", kShallow, kTrustLost, accelerate(4.0, 0, 4000.0)},
      {"acc_below_the_bound_4hz_x", kShallow, kHarmless, accelerate(4.0, 0, 300.0)},
      // Two frames a microsecond apart: what steps between them has stepped at 10 mm/s.
      {"acc_borne_out_by_pairs", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         if (t.n % 2 == 0) t.frame.media_time += fromSeconds(1.0 / kFalseStreamFps - 1e-6);
         moveTo(t, t.n % 2 == 0 ? 10.0 : 10.01);
         t.motion().acceleration_mm_s2.x() = 1200.0 * wave(t.t_s, 2.0);
       }},
      // The same heights resent in every frame bear out no heaving.
      {"heaves_under_the_same_relief", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         heave(2.0, 4.0)(t);
         t.setRelief(plate(10.0));
         t.motion().acceleration_mm_s2 *= 2.0;
       }},
      // It moves as it says, by micrometres.
      {"micrometres_of_a_giant", kShallow, kHarmless, heave(4.0, 0.003),
       [](StreamDescription& description) { description.mass_kg = 1000.0; }},
      {"acc_circles", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         t.motion().acceleration_mm_s2 = {1e5 * wave(t.t_s, 3.0), 1e5 * wave(t.t_s, 3.0, 1.57),
                                          0.0};
       }},
      {"velocity_is_false", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().velocity_mm_s.z() = 1e6 * square(t.t_s, 6.0); }},
      {"velocity_is_false_x", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().velocity_mm_s.x() = 2000.0 * square(t.t_s, 3.0); }},
      {"velocity_and_acceleration_are_false", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.motion().velocity_mm_s.z() = 90.0 * square(t.t_s, 6.25);
         t.motion().acceleration_mm_s2.z() = 1e5 * square(t.t_s, 6.25);
       }},
      {"position_is_false", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.motion().position_mm = {t.between(-1e4, 1e4), t.between(-1e4, 1e4),
                                   t.between(-1e4, 1e4)};
       }},
      {"acceleration_against_motion", kHold, kHarmless,
       [](OutgoingFrame& t) {
         heave(2.0, 5.0)(t);
         t.motion().acceleration_mm_s2 *= -1.0;
       }},
      {"acceleration_with_velocity", kHold, kHarmless,
       [](OutgoingFrame& t) {
         heave(2.0, 5.0)(t);
         t.motion().acceleration_mm_s2 = 12.6 * t.motion().velocity_mm_s;
       }},
      {"angle_1e4", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().angle_rad = 1e4 * square(t.t_s, 6.25); }},
      {"angle_spin", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.motion().angle_rad = std::fmod(70.0 * t.t_s, 6.28);
         t.motion().angular_velocity_rad_s = 70.0;
       }},
      {"angular_velocity_1e4", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().angular_velocity_rad_s = 1e4 * square(t.t_s, 3.0); }},
      {"angular_velocity_far_point", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.motion().position_mm.x() = 1e4;
         t.motion().angular_velocity_rad_s = 10.0 * square(t.t_s, 3.0);
       }},
      {"quality_flips", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.motion().quality = t.n % 2 == 0 ? 0.0 : 1.0;
         t.motion().acceleration_mm_s2.z() = 1e5;
       }},
      {"visible_fraction_flips", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().visible_fraction = t.n % 2 == 0 ? 0.0 : 1.0; }},
      {"reference_point_flips", kHold, kHarmless,
       [](OutgoingFrame& t) { t.motion().reference_point = static_cast<ReferencePoint>(t.n % 3); }},
      {"grid_giant", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         const auto side = static_cast<float>(square(t.t_s, 4.0));
         t.object().grid = gridOf(kPlateau_px, side * Eigen::Vector3f(1e6F, 0.0F, 0.0F),
                                  side * Eigen::Vector3f(1e8F, 0.0F, 0.0F));
       }},
      {"grid_small_4hz", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         const auto side = static_cast<float>(square(t.t_s, 4.0));
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(),
                                  side * Eigen::Vector3f(3000.0F, 0.0F, 3000.0F));
       }},
      {"impact_giant", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.object().impacts = {{t.frame.media_time, {0.0, 0.0, 1e6 * square(t.t_s, 2.0)}}};
       }},
      {"impact_giant_x", kShallow, kTrustLost,
       [](OutgoingFrame& t) {
         t.object().impacts = {{t.frame.media_time, {1e6 * square(t.t_s, 4.0), 0.0, 0.0}}};
       }},
      {"impact_drum", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         for (int i = 0; i < 4; ++i) {
           t.object().impacts.push_back(
               {t.frame.media_time + fromSeconds(0.01 * i), {0.0, 0.0, i % 2 == 0 ? 3e3 : -3e3}});
         }
       }},
      {"impact_always_the_next", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.object().impacts = {{t.frame.media_time + fromSeconds(0.02), {0.0, 0.0, 500.0}}};
       }},
      {"impact_small_drum", kHold, kTrustLost,
       [](OutgoingFrame& t) {
         t.object().impacts = {{t.frame.media_time, {0.0, 0.0, 150.0 * square(t.t_s, 3.0)}}};
       }},
  };
}

namespace {

// --- materials, and what is announced

/// Stiff in one half of the beat of a hand that taps, soft in the other.
auto pumpInStep(double beat) {
  return [=](OutgoingFrame& t) {
    t.material().stiffness_N_mm = square(t.t_s + beat / 7.0, 7.0) > 0 ? 1.5 : 0.2;
  };
}

}  // namespace

FalseStreams material() {
  return {
      {"stiffness_1000", kPress, kLimited,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = 1000.0; }},
      {"stiff_pump_7hz", kHold, kHarmless,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = 0.7 + 0.6 * wave(t.t_s, 7.0); }},
      {"stiff_square_10hz", kHold, kLimited,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = square(t.t_s, 10.0) > 0 ? 5.0 : 0.1; }},
      {"stiffness_flip", kPress, kLimited,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"stiff_pump_1hz", kHold, kHarmless,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = 0.7 + 0.6 * wave(t.t_s, 1.0); }},
      {"stiff_noise", kHold, kLimited,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = t.between(0.0, 10.0); }},
      {"stiff_pump_bounded_7hz", kHold, kHarmless,
       [](OutgoingFrame& t) { t.material().stiffness_N_mm = square(t.t_s, 7.0) > 0 ? 1.0 : 0.4; }},
      {"stiff_pump_in_step_0", ScriptedHand::kTap, kHarmless, pumpInStep(0.0)},
      {"stiff_pump_in_step_90", ScriptedHand::kTap, kLimited, pumpInStep(0.25)},
      {"stiff_pump_in_step_180", ScriptedHand::kTap, kHarmless, pumpInStep(0.5)},
      {"stiff_pump_in_step_270", ScriptedHand::kTap, kHarmless, pumpInStep(0.75)},
      {"damping_1000", kPress, kLimited,
       [](OutgoingFrame& t) { t.material().damping_Ns_m = 1000.0; }},
      {"damping_pump", kHold, kLimited,
       [](OutgoingFrame& t) { t.material().damping_Ns_m = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"friction_1_5_stroke", kStroke, kHarmless,
       [](OutgoingFrame& t) { t.material().static_friction = 1.5; }},
      {"friction_pump", kStroke, kHarmless,
       [](OutgoingFrame& t) { t.material().static_friction = t.n % 4 < 2 ? 1.5 : 0.0; }},
      {"drag_by_friction", kShallow, kHarmless,
       [](OutgoingFrame& t) {
         t.material().static_friction = 1.5;
         const double x_mm = 8.0 * wave(t.t_s, 2.0);
         t.setRelief(plate(10.0, static_cast<int>(std::lround(4.0 * x_mm))));
         t.motion().position_mm.x() = x_mm;
         t.motion().velocity_mm_s.x() = 8.0 * 4.0 * std::numbers::pi * wave(t.t_s, 2.0, 1.5708);
       }},
      {"drag_in_circles", kHold, kLimited,
       [](OutgoingFrame& t) {
         t.material().static_friction = 1.5;
         const Vec2 at_mm(6.0 * wave(t.t_s, 3.0), 6.0 * wave(t.t_s, 3.0, 1.5708));
         t.setRelief(plate(10.0, static_cast<int>(std::lround(4.0 * at_mm.x())),
                           -static_cast<int>(std::lround(4.0 * at_mm.y()))));
         t.motion().position_mm.head<2>() = at_mm;
       }},
      {"texture_flips", kHold, kHarmless,
       [](OutgoingFrame& t) { t.material().texture_K_mm = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"material_chaos", kPress, kLimited,
       [](OutgoingFrame& t) {
         t.material() = {t.between(0.0, 1000.0), t.between(0.0, 1000.0), t.between(0.0, 1.5),
                         t.between(0.0, 1.5),    t.between(0.0, 1000.0), {}};
       }},
      {"mass_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.description.emplace();
         t.description->mass_kg = t.n % 2 == 0 ? 1000.0 : 1e-6;
         t.description->largest_acceleration_mm_s2 = t.n % 2 == 0 ? 0.0 : 1e8;
       }},
      {"fps_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.description.emplace();
         t.description->fps = t.n % 2 == 0 ? 1.0 : 240.0;
       }},
      {"latency_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.description.emplace();
         t.description->pipeline_latency = fromSeconds(t.n % 50 < 25 ? 0.0 : 10.0);
       }},
      {"chaos", kPress, kTrustLost,
       [](OutgoingFrame& t) {
         const auto any = [&](double most) {
           return Vec3(t.between(-most, most), t.between(-most, most), t.between(-most, most));
         };
         t.setRelief(plate(t.between(0.0, 30.0), static_cast<int>(t.between(-60.0, 60.0)),
                           static_cast<int>(t.between(-60.0, 60.0))));
         t.motion() = {any(30.0),
                       any(1e3),
                       any(1e6),
                       t.between(-3.0, 3.0),
                       t.between(-10.0, 10.0),
                       ReferencePoint::kUnknown,
                       t.between(0.0, 1.0),
                       t.between(0.0, 1.0)};
         t.object().impacts = {{t.frame.media_time, any(1e4)}};
         t.object().grid = gridOf(kPlateau_px, any(1e3).cast<float>(), any(1e5).cast<float>());
         t.material() = {t.between(0.0, 5.0), t.between(0.0, 50.0),  t.between(0.0, 1.5),
                         t.between(0.0, 1.5), t.between(0.0, 100.0), {}};
       }},
  };
}

}  // namespace hapticast::testing
