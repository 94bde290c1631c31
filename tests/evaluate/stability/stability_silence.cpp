// SPDX-License-Identifier: MIT
// Force above 50 Hz in a steady press: on a plane with every hand, delay and stiffness, and through
// the whole room on shapes drawn at random.
#include "tests/support/silence.hpp"

#include <cmath>
#include <memory>
#include <random>

#include "client/haptics/room.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/frame_builder.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

// --- a plane
// -----------------------------------------------------------------------------------------

struct PlaneCell {
  const NamedHand* hand;
  int told, real;
  double stiffness_N_mm, friction_N, real_kg, wall_mm;
  Silence got;
};

void addPlanes(std::vector<PlaneCell>& cells, const std::vector<NamedHand>& hands, int later,
               double real_kg) {
  for (const int d : {0, 1, 2, 3, 5}) {
    const double most_N_mm = stiffnessLimit_N_mm(omni(1.0, d));
    for (const double k : {0.5, 1.0, 2.0, 5.0, most_N_mm}) {
      if (k > most_N_mm || d + later < 0) continue;
      for (const NamedHand& hand : hands) {
        for (const double friction_N : {0.0, 0.05}) {
          cells.push_back({&hand, d, d + later, k, friction_N, real_kg, 0.02, {}});
        }
      }
    }
  }
}

struct Worst {
  double rubbed_N = 0.0, smooth_N = 0.0, counts = 0.0;
  std::size_t runs = 0, moving = 0;  // those whose tip moves by more than two counts
};

Worst pressAll(std::vector<PlaneCell>& cells) {
  onAllCores(cells.size(), [&](std::size_t i) {
    PlaneCell& c = cells[i];
    const PlantProfile told = batteryProfile(c.stiffness_N_mm, c.told, c.friction_N);
    PlantProfile real = told;
    real.delay_ticks = c.real;
    real.mass_kg = c.real_kg;
    c.got = pressSteadily(told, real, c.hand->hand, {.wall_mm = c.wall_mm});
  });
  Worst worst;
  for (const PlaneCell& c : cells) {
    double& most_N = c.friction_N > 0.0 ? worst.rubbed_N : worst.smooth_N;
    most_N = std::max(most_N, c.got.above_50Hz_N);
    worst.counts = std::max(worst.counts, c.got.residual_mm / 0.055);
    ++worst.runs;
    worst.moving += c.got.residual_mm > 2.0 * 0.055 ? 1 : 0;
  }
  return worst;
}

void planes(const StabilityReport& to) {
  const auto claim = [&](const std::string& name, const std::vector<NamedHand>& hands, int later,
                         double real_kg) {
    std::vector<PlaneCell> cells;
    addPlanes(cells, hands, later, real_kg);
    const Worst worst = pressAll(cells);
    to.report.add({name, "above_50Hz", "friction 0.05", worst.rubbed_N, "N rms", 0.0, true});
    to.report.add({name, "above_50Hz", "no friction", worst.smooth_N, "N rms", 0.0, true});
    to.report.add({name, "above_50Hz_residual", "worst", worst.counts, "counts", 0.0, true});
    to.claims.add(text("steady 1 N on a plane, %s (%zu runs): force above 50 Hz; residual",
                       name.c_str(), worst.runs),
                  "<= 0.03 N with friction, 0.05 without; 2 counts",
                  text("%.3f, %.3f N; %.2f (more than 2 in %zu)", worst.rubbed_N, worst.smooth_N,
                       worst.counts, worst.moving),
                  worst.rubbed_N <= 0.03 && worst.smooth_N <= 0.05 && worst.counts <= 2.0);
  };
  claim("seven hands", quietHands(), 0, kOmniMass_kg);
  claim("seven hands, a tick later than told", quietHands(), 1, kOmniMass_kg);
  claim("seven hands, a tick earlier than told", quietHands(), -1, kOmniMass_kg);
  claim("seven hands, 35 g", quietHands(), 0, 0.035);
  claim("seven hands, 70 g", quietHands(), 0, 0.07);
  for (const int later : {0, 1}) {
    for (const double real_kg : {0.035, kOmniMass_kg, 0.07}) {
      claim(text("rigid arms, %.0f g, %d later than told", 1e3 * real_kg, later), heavyArms(),
            later, real_kg);
    }
  }
  claim("1 kg behind grips of 2 and 5 kN/m", stiffGrips(), 0, kOmniMass_kg);
}

// --- in motion
// -----------------------------------------------------------------------------------------

struct Moving {
  const NamedHand* hand;
  int way, delay;
  double stiffness_N_mm, friction_N;
  double error_N = 0.0, above_50Hz_N = 0.0;
  int alarms = 0;  // of the latency watch
};
constexpr int kWays = 5;

/// A slow press, 2 Hz and 5 Hz in the wall, taps, tremor: where the hand wants to be, in stretches
/// of 1 N.
double wayOf(int way, double t, double stretch_mm) {
  const double w = 2.0 * M_PI * t;
  switch (way) {
    case 0:
      return 3.0 - (3.0 + 2.0 * stretch_mm) * (0.5 - 0.5 * std::cos(0.25 * w));
    case 1:
      return -stretch_mm * (1.0 + 0.8 * std::sin(2.0 * w));
    case 2:
      return -stretch_mm * (1.0 + 0.6 * std::sin(5.0 * w));
    case 3:
      return 3.0 - (3.0 + 1.5 * stretch_mm) * std::max(0.0, std::sin(3.0 * w));
    default:
      return -stretch_mm + 0.3 * std::sin(9.0 * w);
  }
}

/// The force against K times the true depth, and what of the difference lies above 50 Hz.
void feel(Moving& c) {
  const PlantProfile profile = batteryProfile(c.stiffness_N_mm, c.delay, c.friction_N);
  Rig rig(profile, profile, c.hand->hand);
  const double stretch_mm = 1e3 / c.hand->hand.stiffness_N_m + 1.0 / c.stiffness_N_mm;
  rig.device.reset({0.0, 0.0, 3.0}, Vec3::Zero());
  Above50Hz filter;
  constexpr int kTicks = 4000;
  constexpr int kFrom = 1000;
  for (int i = 0; i < kTicks; ++i) {
    const double wanted_mm = wayOf(c.way, i * 1e-3, stretch_mm);
    rig.device.setTarget({0.0, 0.0, 3.0 + (wanted_mm - 3.0) * std::min(1.0, i / 300.0)});
    c.alarms += rig.step().latency_alarm ? 1 : 0;
    const double depth_mm = std::max(0.0, rig.wall_mm - rig.device.truePosition_mm().z());
    const double off_N = rig.out.force_N.z() - c.stiffness_N_mm * depth_mm;
    const double fast_N = filter.next(off_N);
    if (i < kFrom) continue;
    c.error_N += off_N * off_N / (kTicks - kFrom);
    c.above_50Hz_N += fast_N * fast_N / (kTicks - kFrom);
  }
  c.error_N = std::sqrt(c.error_N);
  c.above_50Hz_N = std::sqrt(c.above_50Hz_N);
}

void inMotion(const StabilityReport& to) {
  std::size_t runs = 0, alarmed = 0;
  for (const double asked_N_mm : {0.5, 2.0, 10.0}) {
    std::vector<Moving> cells;
    for (const int d : {0, 1, 2, 3, 5}) {
      const double k = std::min(asked_N_mm, stiffnessLimit_N_mm(omni(1.0, d)));
      for (int hand = 0; hand < 4; ++hand) {
        for (int way = 0; way < kWays; ++way) {
          for (const double friction_N : {0.0, 0.05}) {
            cells.push_back({&kHands[static_cast<std::size_t>(hand)], way, d, k, friction_N});
          }
        }
      }
    }
    onAllCores(cells.size(), [&](std::size_t i) { feel(cells[i]); });
    double error_N = 0.0;
    double fast_N = 0.0;
    for (const Moving& c : cells) {
      error_N += c.error_N / double(cells.size());
      fast_N += c.above_50Hz_N / double(cells.size());
      alarmed += c.alarms > 0 ? 1 : 0;
    }
    runs += cells.size();
    const std::string name = asked_N_mm > 5.0 ? "K_max" : text("K %g", asked_N_mm);
    to.report.add({"in motion", "moving_error", name, error_N, "N rms", 0.0, true});
    to.report.add({"in motion", "moving_above_50Hz", name, fast_N, "N rms", 0.0, true});
  }
  to.claims.add(text("false alarms of the latency watch in %zu moving runs", runs), "0",
                text("%zu", alarmed), alarmed == 0);
}

/// How far the tip goes to and fro in the last three seconds of a push into the wall, and when the
/// latency watch first raised its alarm (< 0: never).
struct Swing {
  double way_mm = 0.0;
  int alarm_tick = -1;
};

Swing swingOf(const PlantProfile& told, const PlantProfile& real, const Hand& hand, double push_N,
              double speed_mm_s, bool watched) {
  Rig rig(told, real, hand, {.latency_watch = watched});
  const bool free = hand.stiffness_N_m == 0.0;
  const double stretch_mm =
      push_N * ((free ? 0.0 : 1e3 / hand.stiffness_N_m) + 1.0 / rig.renderedStiffness_N_mm());
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -speed_mm_s});
  const int approach = static_cast<int>(20e3 / speed_mm_s);
  Swing swing;
  double low_mm = 1e9, high_mm = -1e9;
  for (int i = 0; i < approach + 4000; ++i) {
    rig.device.setPush({0.0, 0.0, free ? -push_N * std::min(1.0, i / 200.0) : 0.0});
    rig.device.setTarget({0.0, 0.0, std::max(-stretch_mm, 20.0 - 1e-3 * speed_mm_s * i)});
    if (rig.step().latency_alarm && swing.alarm_tick < 0) swing.alarm_tick = i;
    if (i < approach + 1000) continue;
    low_mm = std::min(low_mm, rig.device.truePosition_mm().z());
    high_mm = std::max(high_mm, rig.device.truePosition_mm().z());
  }
  swing.way_mm = high_mm - low_mm;
  return swing;
}

/// Devices that answer two ticks later than told, pushed at random: those that swing without the
/// watch have to be found by it.
void slowDevices(const StabilityReport& to) {
  struct Cell {
    Swing alone, watched;
  };
  std::vector<Cell> cells(300);
  onAllCores(cells.size(), [&](std::size_t i) {
    std::mt19937 random(static_cast<unsigned>(i));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(random);
    };
    std::vector<NamedHand> hands = quietHands();
    hands.insert(hands.end(), heavyArms().begin(), heavyArms().end());
    const Hand hand = hands[random() % hands.size()].hand;
    const int d = static_cast<int>(random() % 4);
    const double k = std::min(stiffnessLimit_N_mm(omni(1.0, d)), std::exp(between(-1.2, 2.5)));
    const PlantProfile told = batteryProfile(k, d, random() % 2 == 0 ? 0.0 : 0.05);
    PlantProfile real = told;
    real.delay_ticks += 2;
    const double push_N = between(0.4, 2.0), speed_mm_s = between(50.0, 400.0);
    cells[i] = {swingOf(told, real, hand, push_N, speed_mm_s, false),
                swingOf(told, real, hand, push_N, speed_mm_s, true)};
  });
  int swinging = 0, found = 0, latest_ms = 0;
  double left_mm = 0.0;
  for (const Cell& c : cells) {
    if (c.alone.way_mm < 10.0 * 0.055) continue;
    ++swinging;
    if (c.watched.alarm_tick < 0) continue;
    ++found;
    latest_ms = std::max(latest_ms, c.watched.alarm_tick);
    left_mm = std::max(left_mm, c.watched.way_mm);
  }
  to.claims.add(
      "two ticks more than told, 300 pushes at random: those that swing by more than ten "
      "counts and are found by the latency watch",
      "all, within 1 s",
      text("%d of %d, within %d ms; then at most %.2f mm", found, swinging, latest_ms, left_mm),
      found == swinging && latest_ms <= 1000);
}

/// The largest rise in a tick beyond K x the hand's way in it, where a tip at 330 mm/s meets the
/// wall.
void firstTouch(const StabilityReport& to) {
  double worst_N = 0.0;
  const auto touch = [&](Rig& rig) {
    const Vec3 before_N = rig.out.force_N;
    const Vec3 before_mm = rig.device.truePosition_mm();
    rig.step();
    if (rig.out.force_N.norm() < before_N.norm()) return;
    const double way_mm = (rig.device.truePosition_mm() - before_mm).norm();
    worst_N = std::max(worst_N, (rig.out.force_N - before_N).norm() - rig.stiffness_N_mm * way_mm);
  };
  for (const double damping_Ns_m : {0.0, 1e9}) {
    for (const int d : {0, 1, 2, 3, 5}) {
      for (int sub = 0; sub < 10; ++sub) {
        const PlantProfile profile = batteryProfile(stiffnessLimit_N_mm(omni(1.0, d)), d);
        Rig rig(profile, profile, Hand::none());
        rig.damping_Ns_m = damping_Ns_m;
        rig.wall_mm = 0.033 * sub;
        rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
        rig.run(250);
        rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -345.0});  // the device rubs
        while (rig.out.force_N.z() == 0.0) touch(rig);
        for (int i = 0; i < 10; ++i) touch(rig);
      }
    }
  }
  to.report.add(
      {"330 mm/s into K_max", "first_touch", "step beyond K x way", worst_N, "N", 0.0, true});
  to.claims.add("first touch at 330 mm/s, K_max, any damping, d 0-5: step beyond K x the way",
                "<= 0.3 N", text("%.2f N", worst_N), worst_N <= 0.3);
}

// --- shapes
// -----------------------------------------------------------------------------------------

using Height = std::function<double(const Vec2&)>;
using Inside = std::function<bool(const Vec2&)>;

struct Shape {
  std::string name;
  std::vector<std::shared_ptr<const HeightField>> fields;
  Vec3 at_mm = Vec3::Zero();      // where it is touched
  Vec3 inwards = -Vec3::UnitZ();  // the way of the hand
};

constexpr PixelRect kRect_px{280, 200, 80, 80};  // +-10 mm about the middle

/// Kinds of shapes with what chance makes of their slopes, widths and of where they are pressed.
std::vector<Shape> shapes(unsigned seed, int each) {
  std::mt19937 random(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(random);
  };
  std::vector<Shape> all;
  const auto put = [&](
                       const char* name, const std::vector<Height>& heights, const Vec2& at_mm,
                       const Inside& inside = [](const Vec2&) { return true; }) {
    Shape shape{name, {}, {at_mm.x(), at_mm.y(), heights[0](at_mm)}};
    for (const Height& height_mm : heights) {
      shape.fields.push_back(makeField(kRect_px, Workspace{}, height_mm, inside));
    }
    all.push_back(shape);
  };
  for (int i = 0; i < each; ++i) {
    const double slope = between(0.3, 1.7);
    const double turn = between(0.0, 3.0);
    const double phase = between(0.0, 6.0);
    const Vec2 across(std::cos(turn), std::sin(turn));
    const Vec2 near(between(-0.1, 0.1), between(-0.1, 0.1));
    put("plate", {[=](const Vec2& at) { return 10.0 + 0.3 * slope * at.dot(across); }}, near);
    put("V groove", {[=](const Vec2& at) { return 10.0 + slope * std::abs(at.dot(across)); }},
        near);
    put("roof", {[=](const Vec2& at) { return 14.0 - slope * std::abs(at.dot(across)); }}, near);
    put("crater", {[=](const Vec2& at) { return 10.0 + 0.2 * slope * at.squaredNorm(); }}, near);
    put("cone", {[=](const Vec2& at) { return 14.0 - 0.6 * slope * at.norm(); }}, near);
    put("ridge",
        {[=](const Vec2& at) { return 10.0 + 3.0 * std::exp(-std::pow(at.dot(across), 2)); }},
        near);
    put("rough", {[=](const Vec2& at) {
          return 10.0 + 0.25 * std::sin(4.0 * at.x() + phase) * std::sin(5.0 * at.y() + turn);
        }},
        near * 20.0);
    put("stepped",
        {[=](const Vec2& at) { return 10.0 + 0.4 * std::floor(1.5 * at.dot(across) + phase); }},
        near);
    const Height level = [](const Vec2&) { return 10.0; };
    const auto box = [](const Vec2& at) { return at.x() < 6.0; };
    const auto aside = [&](const char* name, double x_mm, double under_mm, const Inside& inside) {
      put(name, {level}, Vec2(x_mm, near.y()), inside);
      all.back().at_mm.z() -= under_mm;
      all.back().inwards = -Vec3::UnitX();
    };
    aside("side of a box", 6.0, 5.0, box);
    aside("under its rim", 6.0, 0.3 + std::abs(near.x()), box);
    aside("ragged mask", 5.0, 5.0,
          [=](const Vec2& at) { return at.x() < 4.0 + std::sin(7.0 * at.y() + phase); });
    const auto notch = [](const Vec2& at) { return at.x() < 2.0 + 1.5 * std::abs(at.y()); };
    aside("inner corner of a mask", 2.0, 5.0, notch);
    put("floor at a wall", {[](const Vec2& at) { return at.x() < 0.0 ? 14.0 : 10.0; }},
        Vec2(0.2, 0.0) + near);
    put("two objects, 2 mm apart",
        {[](const Vec2&) { return 10.0; }, [](const Vec2&) { return 8.0; }}, near);
  }
  return all;
}

struct ShapeCell {
  const Shape* shape;
  const NamedHand* hand;
  int delay;
  double stiffness_N_mm, friction_N;
  double above_50Hz_N = 0.0, force_N = 0.0;
};

/// A hand comes down onto the shape, and presses with about 1 N.
void pressShape(ShapeCell& c) {
  ManualClock clock;
  FramePool pool;
  LatestValue<StreamState> stream;
  LatestValue<UserControls> user;
  LatestValue<TickReport> reports;
  RoomSettings settings;
  static_cast<DeviceProfile&>(settings.profile) =
      batteryProfile(c.stiffness_N_mm, c.delay, c.friction_N);
  settings.stiffness_N_mm = c.stiffness_N_mm;
  const auto room = std::make_unique<Room>(settings, pool, stream, user, reports, nullptr);
  VirtualDevice device(batteryProfile(c.stiffness_N_mm, c.delay, c.friction_N), c.hand->hand,
                       clock);
  StreamState control;
  control.connected = true;
  control.first_epoch = 1;
  control.playout_delay_target = Duration(60'000'000);
  stream.store(control);
  const DeviceMapping mapping = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
  const Vec3 surface_mm = mapping.toDevice(c.shape->at_mm);
  const Vec3& inwards = c.shape->inwards;
  device.reset(surface_mm - 5.0 * inwards, Vec3::Zero());
  const double deep_mm = 1e3 / c.hand->hand.stiffness_N_m + 1.0 / c.stiffness_N_mm;
  std::array<Above50Hz, 3> filters;
  double square = 0.0;
  std::uint64_t id = 0;
  constexpr int kTicks = 3500;
  for (int i = 0; i < kTicks; ++i) {
    clock.advance(Duration(1'000'000));
    if (i % 40 == 0) {
      PlayFrame frame;
      frame.epoch = 1;
      frame.id = ++id;
      frame.media_time = mediaTime(toSeconds(clock.now().time_since_epoch()));
      for (const auto& field : c.shape->fields) {
        const auto number = static_cast<std::uint32_t>(frame.object_count + 1);
        frame.objects[frame.object_count++] = makeObject(number, field.get(), {0.0, 0.0, 10.0});
      }
      (void)send(pool, frame);
    }
    const double s = std::clamp((i - 500) / 500.0, 0.0, 1.0);
    device.setTarget(surface_mm + (s * (5.0 + deep_mm) - 5.0) * inwards);
    const TickReport& report = room->tick(clock.now(), device.exchange(room->report().force_N));
    for (int axis = 0; axis < 3; ++axis) {
      const double fast_N = filters[static_cast<std::size_t>(axis)].next(report.force_N[axis]);
      if (i >= kTicks - 1000) square += fast_N * fast_N / 1000.0;
    }
  }
  c.above_50Hz_N = std::sqrt(square);
  c.force_N = room->report().force_N.norm();
}

void onShapes(const StabilityReport& to) {
  const std::vector<Shape> all = shapes(20261122, to.options.quick ? 1 : 4);
  const std::vector<NamedHand>& hands = quietHands();
  std::vector<ShapeCell> cells;
  for (const Shape& shape : all) {
    for (const int d : {0, 1, 3}) {
      const double most_N_mm = stiffnessLimit_N_mm(omni(1.0, d));
      for (const double k : {0.5, 2.0, 5.0, most_N_mm}) {
        if (k > most_N_mm) continue;
        for (const std::size_t hand : {1UL, 2UL, 4UL, 5UL}) {
          if (hands[hand].hand.stiffness_N_m == 0.0) continue;
          for (const double friction_N : {0.0, 0.05}) {
            cells.push_back({&shape, &hands[hand], d, k, friction_N});
          }
        }
      }
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) { pressShape(cells[i]); });
  std::vector<std::vector<std::string>> lines{{"shape", "runs", "friction 0.05: worst N",
                                               "none: worst N", "runs above 0.05 N",
                                               "least force at the end, N"}};
  double rubbed_N = 0.0;
  double smooth_N = 0.0;
  for (std::size_t s = 0; s < all.size() / (to.options.quick ? 1 : 4); ++s) {
    double worst_N[2] = {0.0, 0.0};
    std::size_t runs = 0;
    std::size_t loud = 0;
    double least_N = 1e9;
    for (const ShapeCell& c : cells) {
      if (c.shape->name != all[s].name) continue;
      double& most_N = worst_N[c.friction_N > 0.0 ? 1 : 0];
      most_N = std::max(most_N, c.above_50Hz_N);
      ++runs;
      loud += c.above_50Hz_N > 0.05;
      least_N = std::min(least_N, c.force_N);
    }
    lines.push_back({all[s].name, text("%zu", runs), text("%.3f", worst_N[1]),
                     text("%.3f", worst_N[0]), text("%zu", loud), text("%.2f", least_N)});
    to.report.add(
        {all[s].name, "above_50Hz_shape", "friction 0.05", worst_N[1], "N rms", 0.0, true});
    to.report.add({all[s].name, "above_50Hz_shape", "no friction", worst_N[0], "N rms", 0.0, true});
    rubbed_N = std::max(rubbed_N, worst_N[1]);
    smooth_N = std::max(smooth_N, worst_N[0]);
  }
  to.claims.add(text("steady 1 N through the room on %zu shapes (%zu runs): force above 50 Hz",
                     all.size(), cells.size()),
                "<= 0.03 N with friction, 0.05 without", text("%.3f, %.3f N", rubbed_N, smooth_N),
                rubbed_N <= 0.03 && smooth_N <= 0.05);
  to.report.say("Through the room, shapes drawn at random:\n\n" + markdown(lines));
}

}  // namespace

void stabilitySilence(const StabilityReport& to) {
  to.report.say(
      "### Silence\n\nForce above 50 Hz (N rms, four poles) in the last second of a steady press "
      "of 1 N, after an impact at 0.2 m/s on a plane, after coming down within half a second on "
      "shapes.");
  planes(to);
  inMotion(to);
  slowDevices(to);
  firstTouch(to);
  onShapes(to);
}

}  // namespace hapticast::evaluate
