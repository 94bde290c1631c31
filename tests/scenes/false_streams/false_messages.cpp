// SPDX-License-Identifier: MIT
// False streams with wrong numbers, messages, ids, times and clocks.
#include <array>
#include <cmath>

#include "tests/scenes/false_streams/false_stream_parts.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::testing {

// --- numbers that are none, in each field that carries a float

FalseStreams floats() {
  struct Field {
    const char* name;
    void (*set)(OutgoingFrame&, double);
  };
  constexpr std::array kFields = std::to_array<Field>({
      {"position", [](OutgoingFrame& t, double x) { t.motion().position_mm.x() = x; }},
      {"velocity", [](OutgoingFrame& t, double x) { t.motion().velocity_mm_s.z() = x; }},
      {"acceleration", [](OutgoingFrame& t, double x) { t.motion().acceleration_mm_s2.z() = x; }},
      {"angle", [](OutgoingFrame& t, double x) { t.motion().angle_rad = x; }},
      {"angular_velocity", [](auto& t, double x) { t.motion().angular_velocity_rad_s = x; }},
      {"quality", [](OutgoingFrame& t, double x) { t.motion().quality = x; }},
      {"visible_fraction", [](OutgoingFrame& t, double x) { t.motion().visible_fraction = x; }},
      {"impact",
       [](auto& t, double x) { t.object().impacts = {{t.frame.media_time, {0.0, 0.0, x}}}; }},
      {"stiffness", [](OutgoingFrame& t, double x) { t.material().stiffness_N_mm = x; }},
      {"damping", [](OutgoingFrame& t, double x) { t.material().damping_Ns_m = x; }},
      {"static_friction", [](OutgoingFrame& t, double x) { t.material().static_friction = x; }},
      {"dynamic_friction", [](OutgoingFrame& t, double x) { t.material().dynamic_friction = x; }},
      {"texture_K", [](OutgoingFrame& t, double x) { t.material().texture_K_mm = x; }},
      {"grid_velocity",
       [](OutgoingFrame& t, double x) {
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f(static_cast<float>(x), 0.0F, 0.0F),
                                  Eigen::Vector3f::Zero());
       }},
      {"grid_acceleration",
       [](OutgoingFrame& t, double x) {
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(),
                                  Eigen::Vector3f(static_cast<float>(x), 0.0F, 0.0F));
       }},
      {"fps",
       [](OutgoingFrame& t, double x) {
         t.description.emplace();
         t.description->fps = x;
       }},
      {"largest_acceleration",
       [](OutgoingFrame& t, double x) {
         t.description.emplace();
         t.description->largest_acceleration_mm_s2 = x;
       }},
      {"mass",
       [](OutgoingFrame& t, double x) {
         t.description.emplace();
         t.description->mass_kg = x;
       }},
      {"workspace",
       [](OutgoingFrame& t, double x) {
         t.description.emplace();
         t.description->workspace.width_mm = x;
       }},
  });
  static constexpr std::array<double, 5> kValues = {kNan, kInfinity, -kInfinity, kHuge, -kHuge};
  FalseStreams all;
  for (const Field& field : kFields) {
    const auto set = field.set;
    all.push_back({std::string("floats_") + field.name, kHold, kRefused, [set](OutgoingFrame& t) {
                     if (t.n >= 30) set(t, kValues[t.n % kValues.size()]);
                   }});
  }
  return all;
}

namespace {

// --- messages that are not built as they should be

/// From the 30th frame on, after a first contact.
auto later(void (*change)(OutgoingFrame&)) {
  return [change](OutgoingFrame& t) {
    if (t.n >= 30) change(t);
  };
}

}  // namespace

FalseStreams structure() {
  return {
      {"structure_cut", kHold, kRefused, later([](OutgoingFrame& t) {
         t.bytes = encode(coded(t.frame));
         t.bytes->resize(t.bytes->size() / 2);
       })},
      {"structure_noise", kHold, kRefused, later([](OutgoingFrame& t) {
         t.bytes = encode(coded(t.frame));
         for (auto& byte : *t.bytes) byte = static_cast<std::uint8_t>(t.random());
       })},
      {"structure_empty", kHold, kRefused, later([](OutgoingFrame& t) { t.bytes = Bytes{}; })},
      {"structure_two_kinds", kHold, kRefused, later([](OutgoingFrame& t) {
         t.bytes = encode(coded(t.frame));
         const Bytes also = encode(Ping{});
         t.bytes->insert(t.bytes->end(), also.begin(), also.end());
       })},
      {"structure_clients_word", kHold, kRefused, later([](OutgoingFrame& t) {
         t.bytes = encode(Hello{kProtocolVersion, "server", false, true});
       })},
      {"structure_second_welcome", kHold, kRefused,
       later([](OutgoingFrame& t) { t.bytes = encode(Welcome{}); })},
      {"structure_beyond_1920", kHold, kRefused, later([](OutgoingFrame& t) {
         t.setRelief(flatRelief({1915, 10, 20, 20}));
       })},
      {"structure_17_objects", kHold, kRefused, later([](OutgoingFrame& t) {
         for (std::uint32_t i = 2; i < 18; ++i) {
           HapticObject more = t.object();
           more.id = i;
           t.frame.objects.push_back(more);
         }
       })},
      {"structure_twins", kHold, kRefused,
       later([](OutgoingFrame& t) { t.frame.objects.push_back(t.object()); })},
      {"structure_5_impacts", kHold, kRefused, later([](OutgoingFrame& t) {
         t.object().impacts.assign(5, {t.frame.media_time, {}});
       })},
      {"structure_giant_grid", kHold, kRefused, later([](OutgoingFrame& t) {
         auto grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero());
         grid->columns = grid->rows = 60000;
         t.object().grid = grid;
       })},
      {"structure_short_grid", kHold, kRefused, later([](OutgoingFrame& t) {
         auto grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero());
         grid->velocity_mm_s.pop_back();
         t.object().grid = grid;
       })},
      {"structure_layer_16", kHold, kRefused,
       later([](OutgoingFrame& t) { t.object().layer = 16; })},
      {"structure_unknown_label", kHold, kRefused, later([](OutgoingFrame& t) {
         t.motion().reference_point = static_cast<ReferencePoint>(9);
       })},
      {"structure_tall", kHold, kRefused,
       later([](OutgoingFrame& t) { t.setRelief(flatRelief(kPlateau_px, 3000.0F)); })},
      {"outside", kHold, kRefused, later([](OutgoingFrame& t) {
         t.setRelief(flatRelief({600, 100, 80, 80}));
       })},
      {"too_high", kHold, kRefused,
       later([](OutgoingFrame& t) { t.setRelief(flatRelief(kPlateau_px, 200.0F)); })},
      {"friction_10", kHold, kRefused,
       later([](OutgoingFrame& t) { t.material().static_friction = 10.0; })},
      {"negative_stiffness", kHold, kRefused,
       later([](OutgoingFrame& t) { t.material().stiffness_N_mm = -1000.0; })},
      {"negative_damping", kHold, kRefused,
       later([](OutgoingFrame& t) { t.material().damping_Ns_m = -1000.0; })},
      {"never_sent_relief", kHold, kRefused, later([](OutgoingFrame& t) {
         t.object().relief = nullptr;
         t.object().changed_in_frame = 1'000'000;
       })},
      {"no_motion", kHold, kHarmless, later([](OutgoingFrame& t) { t.motion() = Motion{}; })},
      {"no_objects", kHold, kHarmless, later([](OutgoingFrame& t) { t.frame.objects.clear(); })},
  };
}

// --- ids, epochs, times, clocks

namespace {

/// The frame in whose place another origin begins, and how much earlier its clock is.
constexpr std::uint64_t kOtherOrigin = 60;
constexpr double kOtherOrigin_s = 500.0 + static_cast<double>(kOtherOrigin) / kFalseStreamFps;
constexpr double kEarlier_s = 400.0;

Bytes welcomeAgain() {
  Welcome welcome;
  welcome.description.fps = kFalseStreamFps;
  return encode(welcome);
}

}  // namespace

FalseStreams order() {
  return {
      {"id_max_once", kHold, kHarmless,
       [](OutgoingFrame& t) {
         if (t.n == 40) t.frame.id = std::numeric_limits<std::uint64_t>::max();
       }},
      {"ids_backwards", kHold, kHarmless, [](OutgoingFrame& t) { t.frame.id = 1'000'000 - t.n; }},
      {"ids_leap", kHold, kHarmless,
       [](OutgoingFrame& t) { t.frame.id = t.n % 2 * 1'000'000 + t.n; }},
      {"ids_stand", kHold, kHarmless, later([](OutgoingFrame& t) { t.frame.id = 30; })},
      {"epoch_flips", kHold, kLimited,
       [](OutgoingFrame& t) {
         t.frame.epoch = static_cast<std::uint32_t>(t.n % 2);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"epoch_flips_per_second", kHold, kHarmless,
       [](OutgoingFrame& t) { t.frame.epoch = static_cast<std::uint32_t>(t.n / 25 % 2); }},
      {"object_id_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.object().id = static_cast<std::uint32_t>(1 + t.n % 2);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"layer_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         t.object().layer = static_cast<std::uint32_t>(t.n % 16);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"presence_flips", kHold, kHarmless,
       [](OutgoingFrame& t) {
         if (t.n % 2 == 1) t.frame.objects.clear();
       }},
      {"twice_each", kHold, kHarmless, [](OutgoingFrame& t) { t.copies = 2; }},
      {"forty_each", kHold, kHarmless, [](OutgoingFrame& t) { t.copies = 40; }},
      {"silence", kHold, kHarmless, later([](OutgoingFrame& t) { t.silent = true; })},
      {"stutter", kHold, kHarmless, [](OutgoingFrame& t) { t.silent = t.n % 20 >= 10; }},
      {"times_frozen", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time = mediaTime(501.2); })},
      {"times_backwards", kHold, kHarmless,
       [](OutgoingFrame& t) { t.frame.media_time = mediaTime(501.0 - t.t_s); }},
      {"times_1_s_late", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time -= fromSeconds(1.0); })},
      {"times_1_s_early", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time += fromSeconds(1.0); })},
      {"times_1_h_early", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time += fromSeconds(3600.0); })},
      {"times_30_y_early", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time += fromSeconds(9.4e8); })},
      {"times_30_y_late", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time -= fromSeconds(9.4e8); })},
      {"times_292_y", kHold, kRefused,
       later([](OutgoingFrame& t) { t.frame.media_time = mediaTime(9.2e9); })},
      {"times_random", kHold, kHarmless,
       later([](OutgoingFrame& t) { t.frame.media_time += fromSeconds(t.between(-0.5, 0.5)); })},
      {"times_dense", kHold, kHarmless, later([](OutgoingFrame& t) {
         t.frame.media_time = mediaTime(501.2 + 1e-6 * static_cast<double>(t.n));
       })},
      {"clock_of_another_origin", kHold, kHarmless,
       [](OutgoingFrame& t) {
         if (t.n == kOtherOrigin) t.bytes = welcomeAgain();
         if (t.n <= kOtherOrigin) return;
         t.frame.id -= kOtherOrigin;
         t.frame.media_time -= fromSeconds(kEarlier_s);
       },
       nullptr, [](double s) { return s < kOtherOrigin_s ? s : s - kEarlier_s; }},
      {"welcomes_in_the_session", kHold, kLimited,
       [](OutgoingFrame& t) {
         if (t.n % 30 == 29) t.bytes = welcomeAgain();
       }},
      {"clock_jumps_1_s", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return std::floor(s) == 503.0 ? s + 1.0 : s; }},
      {"clock_jumps_1_h", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return s > 503.0 ? s + 3600.0 : s; }},
      {"clock_292_y", kHold, kRefused, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return s > 503.0 ? 9.2e9 : s; }},
      {"clock_half_speed", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return 0.5 * s; }},
      {"clock_backwards", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return 1000.0 - s; }},
      {"clock_random", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr,
       [](double s) { return s + std::fmod(s * 7919.0, 3.0) - 1.5; }},
      {"no_pongs", kHold, kHarmless, [](OutgoingFrame&) {}, nullptr, nullptr, false},
  };
}

}  // namespace hapticast::testing
