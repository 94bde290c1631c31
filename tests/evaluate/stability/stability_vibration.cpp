// SPDX-License-Identifier: MIT
// Force above 50 Hz in a steady press: on a plane with every hand, delay and stiffness, and through
// the whole renderer on shapes drawn at random.
#include "tests/support/vibration.hpp"

#include <cmath>
#include <memory>
#include <random>

#include "client/haptics/renderer.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/frame_builder.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

// --- a plane
// -----------------------------------------------------------------------------------------

struct PlaneCell {
  const NamedHand* hand;
  int assumed, real;
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
  double excess_N = 0.0;             // step beyond what the hand explains
  std::size_t runs = 0, moving = 0;  // those whose tip moves by more than two counts
};

Worst pressAll(std::vector<PlaneCell>& cells) {
  onAllCores(cells.size(), [&](std::size_t i) {
    PlaneCell& c = cells[i];
    const PlantProfile assumed = sweepProfile(c.stiffness_N_mm, c.assumed, c.friction_N);
    PlantProfile real = assumed;
    real.delay_ticks = c.real;
    real.mass_kg = c.real_kg;
    c.got = pressSteadily(assumed, real, c.hand->hand, {.wall_mm = c.wall_mm});
  });
  Worst worst;
  for (const PlaneCell& c : cells) {
    double& most_N = c.friction_N > 0.0 ? worst.rubbed_N : worst.smooth_N;
    most_N = std::max(most_N, c.got.above_50Hz_N);
    worst.counts = std::max(worst.counts, c.got.residual_mm / 0.055);
    worst.excess_N = std::max(worst.excess_N, c.got.excess_N);
    ++worst.runs;
    worst.moving += c.got.residual_mm > 2.0 * 0.055 ? 1 : 0;
  }
  return worst;
}

void planes(const StabilityReport& to) {
  double excess_N = 0.0;
  const auto claim = [&](const std::string& name, const std::vector<NamedHand>& hands, int later,
                         double real_kg) {
    std::vector<PlaneCell> cells;
    addPlanes(cells, hands, later, real_kg);
    const Worst worst = pressAll(cells);
    excess_N = std::max(excess_N, worst.excess_N);
    to.report.add({name, "above_50Hz", "friction 0.05", worst.rubbed_N, "N rms", 0.0, true});
    to.report.add({name, "above_50Hz", "no friction", worst.smooth_N, "N rms", 0.0, true});
    to.report.add({name, "above_50Hz_residual", "worst", worst.counts, "counts", 0.0, true});
    to.report.require(text("steady 1 N on a plane, %s (%zu runs): force above 50 Hz; residual",
                           name.c_str(), worst.runs),
                      "<= 0.03 N with friction, 0.05 without; 2 counts",
                      text("%.3f, %.3f N; %.2f (more than 2 in %zu)", worst.rubbed_N,
                           worst.smooth_N, worst.counts, worst.moving),
                      worst.rubbed_N <= 0.03 && worst.smooth_N <= 0.05 && worst.counts <= 2.0);
  };
  claim("seven hands", quietHands(), 0, kOmniMass_kg);
  claim("seven hands, a tick later than the profile states", quietHands(), 1, kOmniMass_kg);
  claim("seven hands, a tick earlier than the profile states", quietHands(), -1, kOmniMass_kg);
  claim("seven hands, 35 g", quietHands(), 0, 0.035);
  claim("seven hands, 70 g", quietHands(), 0, 0.07);
  for (const int later : {0, 1}) {
    for (const double real_kg : {0.035, kOmniMass_kg, 0.07}) {
      claim(text("rigid arms, %.0f g, %d later than the profile states", 1e3 * real_kg, later),
            heavyArms(), later, real_kg);
    }
  }
  claim("1 kg behind grips of 2 and 5 kN/m", stiffGrips(), 0, kOmniMass_kg);
  to.report.require("steady 1 N on a plane, all of these: step beyond what the hand explains",
                    "0 N", text("%g N", excess_N), excess_N <= 1e-9);
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
    // Small patterns: the normal changes within a millimetre.
    const double high_mm = between(0.2, 0.6);
    const double wide_mm = between(0.8, 2.0);
    const auto isEven = [=](double along_mm) {
      return std::fmod(std::floor(along_mm / wide_mm + 1000.0), 2.0) == 0.0;
    };
    put("rings", {[=](const Vec2& at) {
          return 10.0 + high_mm * std::cos(2.0 * M_PI * at.norm() / wide_mm);
        }},
        near * 20.0);
    put("checker",
        {[=](const Vec2& at) { return 10.0 + (isEven(at.x()) != isEven(at.y()) ? high_mm : 0.0); }},
        near * 20.0);
    put("pins", {[=](const Vec2& at) {
          return 10.0 + (isEven(2.0 * at.x()) && isEven(2.0 * at.y()) ? 2.0 * high_mm : 0.0);
        }},
        near * 20.0);
    put("pits", {[=](const Vec2& at) {
          return 10.0 - (isEven(2.0 * at.x()) && isEven(2.0 * at.y()) ? 2.0 * high_mm : 0.0);
        }},
        near * 20.0);
    put("steep slope", {[=](const Vec2& at) { return 10.0 + 2.0 * slope * at.dot(across); }}, near);
    put("fine waves", {[=](const Vec2& at) {
          return 10.0 + 0.5 * high_mm * std::sin(2.0 * M_PI * at.dot(across) / wide_mm + phase);
        }},
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
  double real_kg = kOmniMass_kg;
  int later = 0;  // the real delay less the told one
  double above_50Hz_N = 0.0, force_N = 0.0;
};

/// A hand comes down onto the shape, and presses with about 1 N.
void pressShape(ShapeCell& c) {
  ManualClock clock;
  FramePool pool;
  LatestValue<StreamTiming> stream;
  LatestValue<UserControls> user;
  RendererSettings settings;
  static_cast<DeviceProfile&>(settings.profile) =
      sweepProfile(c.stiffness_N_mm, c.delay, c.friction_N);
  settings.stiffness_N_mm = c.stiffness_N_mm;
  const auto renderer = std::make_unique<HapticRenderer>(settings, pool, stream, user, nullptr);
  PlantProfile real = sweepProfile(c.stiffness_N_mm, c.delay + c.later, c.friction_N);
  real.mass_kg = c.real_kg;
  VirtualDevice device(real, c.hand->hand, clock);
  StreamTiming control;
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
    const TickReport& report = renderer->tick(
        clock.now(), device.exchange(renderer->report().force_N, renderer->report()));
    for (int axis = 0; axis < 3; ++axis) {
      const double fast_N = filters[static_cast<std::size_t>(axis)].next(report.force_N[axis]);
      if (i >= kTicks - 1000) square += fast_N * fast_N / 1000.0;
    }
  }
  c.above_50Hz_N = std::sqrt(square);
  c.force_N = renderer->report().force_N.norm();
}

/// What a profile says wrongly: the true mass for 45 g, and the true delay less the told one.
struct Wrong {
  double real_kg = kOmniMass_kg;
  int later = 0;
};

/// Hands for shapes: those with a grip make a device as light as it is.
const std::vector<NamedHand>& shapeHands() {
  static const std::vector<NamedHand> all = {quietHands()[1],
                                             quietHands()[2],
                                             quietHands()[5],
                                             {"300 g grip", {0.3, 5.0, 300.0, 1000.0, 3.0}}};
  return all;
}

std::vector<ShapeCell> pressShapes(const std::vector<Shape>& all, const std::vector<int>& delays,
                                   const std::vector<double>& stiffnesses_N_mm,
                                   const std::vector<Wrong>& wrongs) {
  std::vector<ShapeCell> cells;
  for (const Shape& shape : all) {
    for (const int d : delays) {
      const double most_N_mm = stiffnessLimit_N_mm(omni(1.0, d));
      std::vector<double> ks_N_mm = stiffnesses_N_mm;
      ks_N_mm.push_back(most_N_mm);
      for (const double k : ks_N_mm) {
        if (k > most_N_mm) continue;
        for (const NamedHand& hand : shapeHands()) {
          for (const double friction_N : {0.0, 0.05}) {
            for (const Wrong& wrong : wrongs)
              cells.push_back({&shape, &hand, d, k, friction_N, wrong.real_kg, wrong.later});
          }
        }
      }
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) { pressShape(cells[i]); });
  return cells;
}

/// Light and heavy devices, and those that answer a tick late, under a profile of 45 g.
void onShapesWithWrongProfiles(const StabilityReport& to, const std::vector<Shape>& all) {
  const auto cells = pressShapes(all, {1, 2, 3, 5}, {}, {{0.035, 0}, {0.07, 0}, {kOmniMass_kg, 1}});
  double worst_N[2] = {0.0, 0.0};
  for (const ShapeCell& c : cells) {
    double& most_N = worst_N[c.friction_N > 0.0 ? 1 : 0];
    most_N = std::max(most_N, c.above_50Hz_N);
  }
  const char* const name = "shapes, 35 g, 70 g or a tick late";
  to.report.add({name, "above_50Hz_shape", "friction 0.05", worst_N[1], "N rms", 0.0, true});
  to.report.add({name, "above_50Hz_shape", "no friction", worst_N[0], "N rms", 0.0, true});
  to.report.require(
      text("steady 1 N at K_max on %zu shapes, 35 g or 70 g declared as 45, or a tick late (%zu "
           "runs): force above 50 Hz",
           all.size(), cells.size()),
      "<= 0.08 N", text("%.3f N; %.3f with friction", worst_N[0], worst_N[1]),
      worst_N[0] <= 0.08 && worst_N[1] <= 0.08);
}

void onShapes(const StabilityReport& to) {
  const std::vector<Shape> all = shapes(20261122, to.options.quick ? 1 : 4);
  const auto cells = pressShapes(all, {0, 1, 3}, {0.5, 2.0, 5.0}, {{}});
  Table lines{{"shape", "runs", "friction 0.05: worst N", "none: worst N", "runs above 0.05 N",
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
  to.report.require(text("steady 1 N through the room on %zu shapes (%zu runs): force above 50 Hz",
                         all.size(), cells.size()),
                    "<= 0.03 N with friction, 0.08 without (aim 0.05)",
                    text("%.3f, %.3f N", rubbed_N, smooth_N), rubbed_N <= 0.03 && smooth_N <= 0.08);
  to.report.addTable("shapes", lines);
  onShapesWithWrongProfiles(to, all);
}

}  // namespace

void stabilitySilence(const StabilityReport& to) {
  planes(to);
  stabilityMoving(to);
  onShapes(to);
}

}  // namespace hapticast::evaluate
