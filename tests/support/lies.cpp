// SPDX-License-Identifier: MIT
// The lies, by what they lie about.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "tests/support/flat_relief.hpp"
#include "tests/support/lying_server.hpp"

namespace hapticast::testing {

namespace {

using Lies = std::vector<Lie>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHuge = 3.4e38;
constexpr auto kHold = LiedTo::kHold;
constexpr auto kShallow = LiedTo::kShallow;
constexpr auto kPress = LiedTo::kPress;
constexpr auto kBeside = LiedTo::kBeside;
constexpr auto kStroke = LiedTo::kStroke;
constexpr auto kRefused = Verdict::kRefused;
constexpr auto kLimited = Verdict::kLimited;
constexpr auto kTrustLost = Verdict::kTrustLost;
constexpr auto kHarmless = Verdict::kHarmless;

double square(double t_s, double hz) { return std::fmod(t_s * hz + 1e-9, 1.0) < 0.5 ? 1.0 : -1.0; }
double wave(double t_s, double hz, double phase = 0.0) {
  return std::sin(2.0 * std::numbers::pi * hz * t_s + phase);
}

/// The plateau moved by (du, dv) px and to another height.
std::shared_ptr<Relief> plate(double height_mm, int du = 0, int dv = 0) {
  PixelRect rect = kPlateau_px;
  rect.u += du;
  rect.v += dv;
  return flatRelief(rect, static_cast<float>(std::clamp(height_mm, 0.0, 30.0)));
}

/// Heights by a formula of the pixel's place in the plateau, -1..1 in both directions.
template <class Height>
std::shared_ptr<Relief> shape(Height height_mm) {
  auto relief = flatRelief(kPlateau_px);
  for (int v = 0; v < kPlateau_px.height; ++v) {
    for (int u = 0; u < kPlateau_px.width; ++u) {
      const double x = 2.0 * (u + 0.5) / kPlateau_px.width - 1.0;
      const double y = 1.0 - 2.0 * (v + 0.5) / kPlateau_px.height;
      relief->height_mm[static_cast<std::size_t>(v * kPlateau_px.width + u)] =
          static_cast<float>(std::clamp(height_mm(x, y), 0.0, 30.0));
    }
  }
  return relief;
}

/// The whole plateau at this height, its position with it and, if told, its speed.
void moveTo(Telling& telling, double height_mm, double velocity_mm_s = 0.0) {
  telling.shows(plate(height_mm));
  telling.motion().position_mm.z() = height_mm;
  telling.motion().velocity_mm_s.z() = velocity_mm_s;
}

/// Up and down as it says it does: consistent, and meant to shake.
auto heave(double hz, double amplitude_mm) {
  return [=](Telling& t) {
    const double w = 2.0 * std::numbers::pi * hz;
    moveTo(t, 10.0 + amplitude_mm * wave(t.t_s, hz), amplitude_mm * w * std::cos(w * t.t_s));
    t.motion().acceleration_mm_s2.z() = -amplitude_mm * w * w * wave(t.t_s, hz);
  };
}

std::shared_ptr<MotionGrid> gridOf(const PixelRect& rect, const Eigen::Vector3f& velocity_mm_s,
                                   const Eigen::Vector3f& acceleration_mm_s2) {
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = gridCells(rect.width);
  grid->rows = gridCells(rect.height);
  const auto cells = static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
  grid->velocity_mm_s.assign(cells, velocity_mm_s);
  grid->acceleration_mm_s2.assign(cells, acceleration_mm_s2);
  return grid;
}

template <class... More>
void append(Lies& to, More&&... more) {
  (std::move(more.begin(), more.end(), std::back_inserter(to)), ...);
}

// --- numbers that are none, in each field that carries a float

Lies floats() {
  struct Field {
    const char* name;
    void (*set)(Telling&, double);
  };
  constexpr std::array kFields = std::to_array<Field>({
      {"position", [](Telling& t, double x) { t.motion().position_mm.x() = x; }},
      {"velocity", [](Telling& t, double x) { t.motion().velocity_mm_s.z() = x; }},
      {"acceleration", [](Telling& t, double x) { t.motion().acceleration_mm_s2.z() = x; }},
      {"angle", [](Telling& t, double x) { t.motion().angle_rad = x; }},
      {"angular_velocity", [](Telling& t, double x) { t.motion().angular_velocity_rad_s = x; }},
      {"quality", [](Telling& t, double x) { t.motion().quality = x; }},
      {"visible_fraction", [](Telling& t, double x) { t.motion().visible_fraction = x; }},
      {"impact",
       [](Telling& t, double x) { t.object().impacts = {{t.frame.media_time, {0.0, 0.0, x}}}; }},
      {"stiffness", [](Telling& t, double x) { t.material().stiffness_N_mm = x; }},
      {"damping", [](Telling& t, double x) { t.material().damping_Ns_m = x; }},
      {"static_friction", [](Telling& t, double x) { t.material().static_friction = x; }},
      {"dynamic_friction", [](Telling& t, double x) { t.material().dynamic_friction = x; }},
      {"texture_K", [](Telling& t, double x) { t.material().texture_K_mm = x; }},
      {"grid_velocity",
       [](Telling& t, double x) {
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f(static_cast<float>(x), 0.0F, 0.0F),
                                  Eigen::Vector3f::Zero());
       }},
      {"grid_acceleration",
       [](Telling& t, double x) {
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(),
                                  Eigen::Vector3f(static_cast<float>(x), 0.0F, 0.0F));
       }},
      {"fps",
       [](Telling& t, double x) {
         t.description.emplace();
         t.description->fps = x;
       }},
      {"largest_acceleration",
       [](Telling& t, double x) {
         t.description.emplace();
         t.description->largest_acceleration_mm_s2 = x;
       }},
      {"mass",
       [](Telling& t, double x) {
         t.description.emplace();
         t.description->mass_kg = x;
       }},
      {"workspace",
       [](Telling& t, double x) {
         t.description.emplace();
         t.description->workspace.width_mm = x;
       }},
  });
  static constexpr std::array<double, 5> kValues = {kNan, kInfinity, -kInfinity, kHuge, -kHuge};
  Lies all;
  for (const Field& field : kFields) {
    const auto set = field.set;
    all.push_back({std::string("floats_") + field.name, kHold, kRefused, [set](Telling& t) {
                     if (t.n >= 30) set(t, kValues[t.n % kValues.size()]);
                   }});
  }
  return all;
}

// --- messages that are not built as they should be

/// From the 30th frame on, so that something is felt before.
auto later(void (*change)(Telling&)) {
  return [change](Telling& t) {
    if (t.n >= 30) change(t);
  };
}

Lies structure() {
  return {
      {"structure_cut", kHold, kRefused, later([](Telling& t) {
         t.bytes = encode(t.frame);
         t.bytes->resize(t.bytes->size() / 2);
       })},
      {"structure_noise", kHold, kRefused, later([](Telling& t) {
         t.bytes = encode(t.frame);
         for (auto& byte : *t.bytes) byte = static_cast<std::uint8_t>(t.random());
       })},
      {"structure_empty", kHold, kRefused, later([](Telling& t) { t.bytes = Bytes{}; })},
      {"structure_two_kinds", kHold, kRefused, later([](Telling& t) {
         t.bytes = encode(t.frame);
         const Bytes also = encode(Ping{});
         t.bytes->insert(t.bytes->end(), also.begin(), also.end());
       })},
      {"structure_clients_word", kHold, kRefused, later([](Telling& t) {
         t.bytes = encode(Hello{kProtocolVersion, "liar", false, true});
       })},
      {"structure_second_welcome", kHold, kRefused,
       later([](Telling& t) { t.bytes = encode(Welcome{}); })},
      {"structure_beyond_1920", kHold, kRefused, later([](Telling& t) {
         t.shows(flatRelief({1915, 10, 20, 20}));
       })},
      {"structure_no_pixel", kHold, kRefused, later([](Telling& t) {
         auto relief = flatRelief(kPlateau_px);
         std::fill(relief->mask.begin(), relief->mask.end(), std::uint8_t{0});
         t.shows(relief);
       })},
      {"structure_17_objects", kHold, kRefused, later([](Telling& t) {
         for (std::uint32_t i = 2; i < 18; ++i) {
           HapticObject more = t.object();
           more.id = i;
           t.frame.objects.push_back(more);
         }
       })},
      {"structure_twins", kHold, kRefused,
       later([](Telling& t) { t.frame.objects.push_back(t.object()); })},
      {"structure_5_impacts", kHold, kRefused, later([](Telling& t) {
         t.object().impacts.assign(5, {t.frame.media_time, {}});
       })},
      {"structure_giant_grid", kHold, kRefused, later([](Telling& t) {
         auto grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero());
         grid->columns = grid->rows = 60000;
         t.object().grid = grid;
       })},
      {"structure_short_grid", kHold, kRefused, later([](Telling& t) {
         auto grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero());
         grid->velocity_mm_s.pop_back();
         t.object().grid = grid;
       })},
      {"structure_layer_16", kHold, kRefused, later([](Telling& t) { t.object().layer = 16; })},
      {"structure_unknown_label", kHold, kRefused,
       later([](Telling& t) { t.motion().reference_point = static_cast<ReferencePoint>(9); })},
      {"structure_tall", kHold, kRefused,
       later([](Telling& t) { t.shows(flatRelief(kPlateau_px, 3000.0F)); })},
      {"outside", kHold, kRefused, later([](Telling& t) {
         t.shows(flatRelief({600, 100, 80, 80}));
       })},
      {"too_high", kHold, kRefused,
       later([](Telling& t) { t.shows(flatRelief(kPlateau_px, 200.0F)); })},
      {"friction_10", kHold, kRefused,
       later([](Telling& t) { t.material().static_friction = 10.0; })},
      {"negative_stiffness", kHold, kRefused,
       later([](Telling& t) { t.material().stiffness_N_mm = -1000.0; })},
      {"negative_damping", kHold, kRefused,
       later([](Telling& t) { t.material().damping_Ns_m = -1000.0; })},
      {"never_sent_relief", kHold, kRefused, later([](Telling& t) {
         t.object().relief = nullptr;
         t.object().changed_in_frame = 1'000'000;
       })},
      {"no_motion", kHold, kHarmless, later([](Telling& t) { t.motion() = Motion{}; })},
      {"no_objects", kHold, kHarmless, later([](Telling& t) { t.frame.objects.clear(); })},
  };
}

// --- ids, epochs, times, clocks

Lies order() {
  return {
      {"id_max_once", kHold, kLimited,
       [](Telling& t) {
         if (t.n == 40) t.frame.id = std::numeric_limits<std::uint64_t>::max();
       }},
      {"ids_backwards", kHold, kHarmless, [](Telling& t) { t.frame.id = 1'000'000 - t.n; }},
      {"ids_leap", kHold, kHarmless, [](Telling& t) { t.frame.id = t.n % 2 * 1'000'000 + t.n; }},
      {"ids_stand", kHold, kHarmless, later([](Telling& t) { t.frame.id = 30; })},
      {"epoch_flips", kHold, kLimited,
       [](Telling& t) {
         t.frame.epoch = static_cast<std::uint32_t>(t.n % 2);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"epoch_flips_per_second", kHold, kLimited,
       [](Telling& t) { t.frame.epoch = static_cast<std::uint32_t>(t.n / 25 % 2); }},
      {"object_id_flips", kHold, kLimited,
       [](Telling& t) {
         t.object().id = static_cast<std::uint32_t>(1 + t.n % 2);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"layer_flips", kHold, kLimited,
       [](Telling& t) {
         t.object().layer = static_cast<std::uint32_t>(t.n % 16);
         t.object().relief = flatRelief(kPlateau_px, kPlateau_mm);
       }},
      {"presence_flips", kHold, kLimited,
       [](Telling& t) {
         if (t.n % 2 == 1) t.frame.objects.clear();
       }},
      {"twice_each", kHold, kHarmless, [](Telling& t) { t.copies = 2; }},
      {"forty_each", kHold, kHarmless, [](Telling& t) { t.copies = 40; }},
      {"silence", kHold, kHarmless, later([](Telling& t) { t.silent = true; })},
      {"stutter", kHold, kHarmless, [](Telling& t) { t.silent = t.n % 20 >= 10; }},
      {"times_frozen", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time = mediaTime(501.2); })},
      {"times_backwards", kHold, kHarmless,
       [](Telling& t) { t.frame.media_time = mediaTime(501.0 - t.t_s); }},
      {"times_1_s_late", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time -= fromSeconds(1.0); })},
      {"times_1_s_early", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time += fromSeconds(1.0); })},
      {"times_1_h_early", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time += fromSeconds(3600.0); })},
      {"times_30_y_early", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time += fromSeconds(9.4e8); })},
      {"times_30_y_late", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time -= fromSeconds(9.4e8); })},
      {"times_292_y", kHold, kRefused,
       later([](Telling& t) { t.frame.media_time = mediaTime(9.2e9); })},
      {"times_random", kHold, kHarmless,
       later([](Telling& t) { t.frame.media_time += fromSeconds(t.between(-0.5, 0.5)); })},
      {"times_dense", kHold, kHarmless, later([](Telling& t) {
         t.frame.media_time = mediaTime(501.2 + 1e-6 * static_cast<double>(t.n));
       })},
      {"clock_jumps_1_s", kHold, kHarmless, [](Telling&) {}, nullptr,
       [](double s) { return std::floor(s) == 503.0 ? s + 1.0 : s; }},
      {"clock_jumps_1_h", kHold, kHarmless, [](Telling&) {}, nullptr,
       [](double s) { return s > 503.0 ? s + 3600.0 : s; }},
      {"clock_292_y", kHold, kRefused, [](Telling&) {}, nullptr,
       [](double s) { return s > 503.0 ? 9.2e9 : s; }},
      {"clock_half_speed", kHold, kHarmless, [](Telling&) {}, nullptr,
       [](double s) { return 0.5 * s; }},
      {"clock_backwards", kHold, kHarmless, [](Telling&) {}, nullptr,
       [](double s) { return 1000.0 - s; }},
      {"clock_random", kHold, kHarmless, [](Telling&) {}, nullptr,
       [](double s) { return s + std::fmod(s * 7919.0, 3.0) - 1.5; }},
      {"no_pongs", kHold, kHarmless, [](Telling&) {}, nullptr, nullptr, false},
  };
}

// --- geometry

Lies geometry() {
  return {
      {"spikes", kHold, kHarmless,
       [](Telling& t) {
         t.shows(shape([&](double, double) { return t.between(0.0, 1.0) < 0.02 ? 30.0 : 10.0; }));
       }},
      {"strobe_2mm", kHold, kHarmless, [](Telling& t) { moveTo(t, t.n % 2 == 0 ? 10.0 : 12.0); }},
      {"strobe_20mm", kHold, kTrustLost, [](Telling& t) { moveTo(t, t.n % 2 == 0 ? 5.0 : 25.0); }},
      {"strobe_20mm_new_ids", kHold, kLimited,
       [](Telling& t) {
         moveTo(t, t.n % 2 == 0 ? 5.0 : 25.0);
         t.object().id = static_cast<std::uint32_t>(t.n);
       }},
      {"surface_30mm_above", kShallow, kLimited,
       [](Telling& t) { moveTo(t, t.n % 50 < 25 ? 10.0 : 30.0); }},
      {"to_and_fro_40px", kHold, kHarmless,
       [](Telling& t) {
         const int side = t.n % 2 == 0 ? 40 : -40;
         t.shows(plate(10.0, side));
         t.motion().position_mm.x() = 0.25 * side;
       }},
      {"side_sweep_box", kBeside, kHarmless,
       [](Telling& t) {
         const double x_mm = 12.0 * wave(t.t_s, 1.5);
         t.shows(plate(20.0, static_cast<int>(std::lround(4.0 * x_mm))));
         t.motion().position_mm = {x_mm, 0.0, 20.0};
         t.motion().velocity_mm_s.x() =
             12.0 * 2.0 * std::numbers::pi * 1.5 * wave(t.t_s, 1.5, std::numbers::pi / 2.0);
       }},
      {"oscillate_2hz", kHold, kHarmless, heave(2.0, 5.0)},
      {"oscillate_5hz", kHold, kLimited, heave(5.0, 4.0)},
      {"oscillate_8hz", kHold, kLimited, heave(8.0, 4.0)},
      {"oscillate_12hz", kHold, kTrustLost, heave(12.0, 4.0)},
      {"oscillate_12hz_press", kPress, kLimited, heave(12.0, 4.0)},
      {"ratchet", kHold, kHarmless,
       [](Telling& t) {
         const double rise = std::fmod(t.t_s * 5.0, 1.0);
         moveTo(t, 8.0 + 6.0 * rise, 30.0);
       }},
      {"travelling_wave", kHold, kLimited,
       [](Telling& t) {
         t.shows(shape([&](double x, double) { return 10.0 + 3.0 * wave(t.t_s + x, 3.0); }));
       }},
      {"tilting_plate", kHold, kHarmless,
       [](Telling& t) {
         t.shows(shape([&](double x, double y) {
           return 10.0 + 5.0 * (x * wave(t.t_s, 4.0) + y * wave(t.t_s, 4.0, 1.57));
         }));
       }},
      {"checkerboard", kHold, kHarmless,
       [](Telling& t) {
         auto relief = flatRelief(kPlateau_px, 12.0F);
         for (std::size_t i = 0; i < relief->mask.size(); ++i) {
           const std::size_t side = static_cast<std::size_t>(kPlateau_px.width);
           relief->mask[i] = static_cast<std::uint8_t>((i % side / 4 + i / side / 4 + t.n) % 2);
         }
         t.shows(relief);
       }},
      {"overlapping_turns", kHold, kLimited,
       [](Telling& t) {
         for (std::uint32_t i = 2; i < 6; ++i) {
           HapticObject more = t.object();
           more.id = i;
           more.relief = plate((t.n + i) % 4 == 0 ? 14.0 : 6.0);
           more.changed_in_frame = t.frame.id;
           t.frame.objects.push_back(more);
         }
       }},
      {"heights_of_noise", kHold, kLimited,
       [](Telling& t) { t.shows(shape([&](double, double) { return t.between(5.0, 15.0); })); }},
      {"random_heights", kHold, kTrustLost,
       [](Telling& t) { moveTo(t, t.between(2.0, 20.0), t.between(-500.0, 500.0)); }},
      {"relief_without_motion", kHold, kLimited,
       [](Telling& t) { t.shows(plate(10.0 + 4.0 * wave(t.t_s, 5.0))); }},
      {"motion_without_relief", kHold, kLimited,
       [](Telling& t) { t.motion().position_mm.z() = 10.0 + 4.0 * wave(t.t_s, 5.0); }},
      {"workspace_flips", kHold, kLimited,
       [](Telling& t) {
         if (t.n % 10 != 0) return;
         t.description.emplace();
         t.description->workspace.width_mm = t.n % 20 == 0 ? 160.0 : 320.0;
         t.description->workspace.height_mm = t.n % 20 == 0 ? 120.0 : 240.0;
       }},
  };
}

// --- motion that the positions do not bear out

auto accelerate(double hz, int axis, double amplitude_mm_s2) {
  return [=](Telling& t) {
    t.motion().acceleration_mm_s2[axis] = amplitude_mm_s2 * square(t.t_s, hz);
  };
}
void announceAll(StreamDescription& description) { description.largest_acceleration_mm_s2 = 1e8; }
void announceSmall(StreamDescription& description) {
  description.largest_acceleration_mm_s2 = 1.0;
  description.mass_kg = 1000.0;
}

Lies motion() {
  return {
      {"acceleration_1e8", kHold, kTrustLost,
       [](Telling& t) { t.motion().acceleration_mm_s2.z() = 1e8; }},
      {"acceleration_1e8_described", kShallow, kTrustLost,
       [](Telling& t) {
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
       [](Telling& t) {
         if (t.n % 2 == 0) t.frame.media_time += fromSeconds(1.0 / kLiarsFps - 1e-6);
         moveTo(t, t.n % 2 == 0 ? 10.0 : 10.01);
         t.motion().acceleration_mm_s2.x() = 1200.0 * wave(t.t_s, 2.0);
       }},
      // The same heights resent in every frame bear out no heaving.
      {"heaves_under_the_same_relief", kShallow, kTrustLost,
       [](Telling& t) {
         heave(2.0, 4.0)(t);
         t.shows(plate(10.0));
         t.motion().acceleration_mm_s2 *= 2.0;
       }},
      // It moves as it says, by micrometres.
      {"micrometres_of_a_giant", kShallow, kHarmless, heave(4.0, 0.003),
       [](StreamDescription& description) { description.mass_kg = 1000.0; }},
      {"acc_circles", kShallow, kTrustLost,
       [](Telling& t) {
         t.motion().acceleration_mm_s2 = {1e5 * wave(t.t_s, 3.0), 1e5 * wave(t.t_s, 3.0, 1.57),
                                          0.0};
       }},
      {"velocity_lies", kHold, kHarmless,
       [](Telling& t) { t.motion().velocity_mm_s.z() = 1e6 * square(t.t_s, 6.0); }},
      {"velocity_lies_x", kHold, kHarmless,
       [](Telling& t) { t.motion().velocity_mm_s.x() = 2000.0 * square(t.t_s, 3.0); }},
      {"velocity_and_acceleration_lie", kHold, kTrustLost,
       [](Telling& t) {
         t.motion().velocity_mm_s.z() = 90.0 * square(t.t_s, 6.25);
         t.motion().acceleration_mm_s2.z() = 1e5 * square(t.t_s, 6.25);
       }},
      {"position_lies", kHold, kHarmless,
       [](Telling& t) {
         t.motion().position_mm = {t.between(-1e4, 1e4), t.between(-1e4, 1e4),
                                   t.between(-1e4, 1e4)};
       }},
      {"acceleration_against_motion", kHold, kHarmless,
       [](Telling& t) {
         heave(2.0, 5.0)(t);
         t.motion().acceleration_mm_s2 *= -1.0;
       }},
      {"acceleration_with_velocity", kHold, kHarmless,
       [](Telling& t) {
         heave(2.0, 5.0)(t);
         t.motion().acceleration_mm_s2 = 12.6 * t.motion().velocity_mm_s;
       }},
      {"angle_1e4", kHold, kHarmless,
       [](Telling& t) { t.motion().angle_rad = 1e4 * square(t.t_s, 6.25); }},
      {"angle_spin", kHold, kHarmless,
       [](Telling& t) {
         t.motion().angle_rad = std::fmod(70.0 * t.t_s, 6.28);
         t.motion().angular_velocity_rad_s = 70.0;
       }},
      {"angular_velocity_1e4", kHold, kHarmless,
       [](Telling& t) { t.motion().angular_velocity_rad_s = 1e4 * square(t.t_s, 3.0); }},
      {"angular_velocity_far_point", kHold, kTrustLost,
       [](Telling& t) {
         t.motion().position_mm.x() = 1e4;
         t.motion().angular_velocity_rad_s = 10.0 * square(t.t_s, 3.0);
       }},
      {"quality_flips", kHold, kTrustLost,
       [](Telling& t) {
         t.motion().quality = t.n % 2 == 0 ? 0.0 : 1.0;
         t.motion().acceleration_mm_s2.z() = 1e5;
       }},
      {"visible_fraction_flips", kHold, kHarmless,
       [](Telling& t) { t.motion().visible_fraction = t.n % 2 == 0 ? 0.0 : 1.0; }},
      {"reference_point_flips", kHold, kHarmless,
       [](Telling& t) { t.motion().reference_point = static_cast<ReferencePoint>(t.n % 3); }},
      {"grid_giant", kShallow, kTrustLost,
       [](Telling& t) {
         const auto side = static_cast<float>(square(t.t_s, 4.0));
         t.object().grid = gridOf(kPlateau_px, side * Eigen::Vector3f(1e6F, 0.0F, 0.0F),
                                  side * Eigen::Vector3f(1e8F, 0.0F, 0.0F));
       }},
      {"grid_small_4hz", kShallow, kTrustLost,
       [](Telling& t) {
         const auto side = static_cast<float>(square(t.t_s, 4.0));
         t.object().grid = gridOf(kPlateau_px, Eigen::Vector3f::Zero(),
                                  side * Eigen::Vector3f(3000.0F, 0.0F, 3000.0F));
       }},
      {"impact_giant", kHold, kTrustLost,
       [](Telling& t) {
         t.object().impacts = {{t.frame.media_time, {0.0, 0.0, 1e6 * square(t.t_s, 2.0)}}};
       }},
      {"impact_giant_x", kShallow, kTrustLost,
       [](Telling& t) {
         t.object().impacts = {{t.frame.media_time, {1e6 * square(t.t_s, 4.0), 0.0, 0.0}}};
       }},
      {"impact_drum", kHold, kTrustLost,
       [](Telling& t) {
         for (int i = 0; i < 4; ++i) {
           t.object().impacts.push_back(
               {t.frame.media_time + fromSeconds(0.01 * i), {0.0, 0.0, i % 2 == 0 ? 3e3 : -3e3}});
         }
       }},
      {"impact_always_the_next", kHold, kTrustLost,
       [](Telling& t) {
         t.object().impacts = {{t.frame.media_time + fromSeconds(0.02), {0.0, 0.0, 500.0}}};
       }},
      {"impact_small_drum", kHold, kTrustLost,
       [](Telling& t) {
         t.object().impacts = {{t.frame.media_time, {0.0, 0.0, 150.0 * square(t.t_s, 3.0)}}};
       }},
  };
}

// --- materials, and what is announced

/// Stiff in one half of the beat of a hand that taps, soft in the other.
auto pumpInStep(double beat) {
  return [=](Telling& t) {
    t.material().stiffness_N_mm = square(t.t_s + beat / 7.0, 7.0) > 0 ? 1.5 : 0.2;
  };
}

Lies material() {
  return {
      {"stiffness_1000", kPress, kLimited,
       [](Telling& t) { t.material().stiffness_N_mm = 1000.0; }},
      {"stiff_pump_7hz", kHold, kHarmless,
       [](Telling& t) { t.material().stiffness_N_mm = 0.7 + 0.6 * wave(t.t_s, 7.0); }},
      {"stiff_square_10hz", kHold, kLimited,
       [](Telling& t) { t.material().stiffness_N_mm = square(t.t_s, 10.0) > 0 ? 5.0 : 0.1; }},
      {"stiffness_flip", kPress, kLimited,
       [](Telling& t) { t.material().stiffness_N_mm = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"stiff_pump_1hz", kHold, kHarmless,
       [](Telling& t) { t.material().stiffness_N_mm = 0.7 + 0.6 * wave(t.t_s, 1.0); }},
      {"stiff_noise", kHold, kLimited,
       [](Telling& t) { t.material().stiffness_N_mm = t.between(0.0, 10.0); }},
      {"stiff_pump_bounded_7hz", kHold, kHarmless,
       [](Telling& t) { t.material().stiffness_N_mm = square(t.t_s, 7.0) > 0 ? 1.0 : 0.4; }},
      {"stiff_pump_in_step_0", LiedTo::kTap, kHarmless, pumpInStep(0.0)},
      {"stiff_pump_in_step_90", LiedTo::kTap, kHarmless, pumpInStep(0.25)},
      {"stiff_pump_in_step_180", LiedTo::kTap, kHarmless, pumpInStep(0.5)},
      {"stiff_pump_in_step_270", LiedTo::kTap, kHarmless, pumpInStep(0.75)},
      {"damping_1000", kPress, kLimited, [](Telling& t) { t.material().damping_Ns_m = 1000.0; }},
      {"damping_pump", kHold, kLimited,
       [](Telling& t) { t.material().damping_Ns_m = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"friction_1_5_stroke", kStroke, kHarmless,
       [](Telling& t) { t.material().static_friction = 1.5; }},
      {"friction_pump", kStroke, kHarmless,
       [](Telling& t) { t.material().static_friction = t.n % 4 < 2 ? 1.5 : 0.0; }},
      {"drag_by_friction", kShallow, kHarmless,
       [](Telling& t) {
         t.material().static_friction = 1.5;
         const double x_mm = 8.0 * wave(t.t_s, 2.0);
         t.shows(plate(10.0, static_cast<int>(std::lround(4.0 * x_mm))));
         t.motion().position_mm.x() = x_mm;
         t.motion().velocity_mm_s.x() = 8.0 * 4.0 * std::numbers::pi * wave(t.t_s, 2.0, 1.5708);
       }},
      {"drag_in_circles", kHold, kHarmless,
       [](Telling& t) {
         t.material().static_friction = 1.5;
         const Vec2 at_mm(6.0 * wave(t.t_s, 3.0), 6.0 * wave(t.t_s, 3.0, 1.5708));
         t.shows(plate(10.0, static_cast<int>(std::lround(4.0 * at_mm.x())),
                       -static_cast<int>(std::lround(4.0 * at_mm.y()))));
         t.motion().position_mm.head<2>() = at_mm;
       }},
      {"texture_flips", kHold, kHarmless,
       [](Telling& t) { t.material().texture_K_mm = t.n % 2 == 0 ? 1000.0 : 0.0; }},
      {"material_chaos", kPress, kLimited,
       [](Telling& t) {
         t.material() = {t.between(0.0, 1000.0), t.between(0.0, 1000.0), t.between(0.0, 1.5),
                         t.between(0.0, 1.5), t.between(0.0, 1000.0)};
       }},
      {"mass_flips", kHold, kHarmless,
       [](Telling& t) {
         t.description.emplace();
         t.description->mass_kg = t.n % 2 == 0 ? 1000.0 : 1e-6;
         t.description->largest_acceleration_mm_s2 = t.n % 2 == 0 ? 0.0 : 1e8;
       }},
      {"fps_flips", kHold, kHarmless,
       [](Telling& t) {
         t.description.emplace();
         t.description->fps = t.n % 2 == 0 ? 1.0 : 240.0;
       }},
      {"latency_flips", kHold, kHarmless,
       [](Telling& t) {
         t.description.emplace();
         t.description->pipeline_latency = fromSeconds(t.n % 50 < 25 ? 0.0 : 10.0);
       }},
      {"chaos", kPress, kTrustLost,
       [](Telling& t) {
         const auto any = [&](double most) {
           return Vec3(t.between(-most, most), t.between(-most, most), t.between(-most, most));
         };
         t.shows(plate(t.between(0.0, 30.0), static_cast<int>(t.between(-60.0, 60.0)),
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
         t.material() = {t.between(0.0, 5.0), t.between(0.0, 50.0), t.between(0.0, 1.5),
                         t.between(0.0, 1.5), t.between(0.0, 100.0)};
       }},
  };
}

Lies all() {
  Lies all;
  append(all, floats(), structure(), order(), geometry(), motion(), material());
  return all;
}

}  // namespace

const std::vector<Lie>& lies() {
  static const Lies kAll = all();
  return kAll;
}

}  // namespace hapticast::testing
