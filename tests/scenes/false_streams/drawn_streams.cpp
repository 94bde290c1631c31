// SPDX-License-Identifier: MIT
// False streams drawn at random: a motion of the plateau, one or two disturbances of random rate
// and size, and a hand. No value of the product was chosen with them.
#include <fmt/core.h>

#include <array>
#include <cmath>

#include "tests/scenes/false_streams/false_stream_parts.hpp"

namespace hapticast::testing {

namespace {

using Random = std::mt19937_64;
using Alter = std::function<void(OutgoingFrame&)>;

struct NamedAlter {
  std::string name;
  Alter alter;
};

double draw(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}
/// A rate or a size: each decade is as likely.
double drawLog(Random& random, double low, double high) {
  return std::exp(draw(random, std::log(low), std::log(high)));
}
int drawIndex(Random& random, int count) {
  return std::uniform_int_distribution(0, count - 1)(random);
}

/// The plateau in circles or to and fro, with its true velocity and acceleration.
Alter slide(double hz, double x_mm, double y_mm) {
  return [=](OutgoingFrame& t) {
    const double w = 2.0 * std::numbers::pi * hz;
    const Vec2 at_mm(x_mm * wave(t.t_s, hz), y_mm * wave(t.t_s, hz, std::numbers::pi / 2.0));
    t.setRelief(plate(10.0, static_cast<int>(std::lround(4.0 * at_mm.x())),
                      -static_cast<int>(std::lround(4.0 * at_mm.y()))));
    t.motion().position_mm.head<2>() = at_mm;
    t.motion().velocity_mm_s.head<2>() =
        w * Vec2(x_mm * wave(t.t_s, hz, std::numbers::pi / 2.0), -y_mm * wave(t.t_s, hz));
    t.motion().acceleration_mm_s2.head<2>() = -w * w * at_mm;
  };
}

NamedAlter drawMotion(Random& random) {
  const double hz = drawLog(random, 0.3, 12.0);
  const double size_mm = drawLog(random, 1.0, 10.0);
  switch (drawIndex(random, 4)) {
    case 0:
      return {fmt::format("heave {:.1f} mm {:.1f} Hz", size_mm, hz), heave(hz, size_mm)};
    case 1:
      return {fmt::format("circle {:.1f} mm {:.1f} Hz", size_mm, hz), slide(hz, size_mm, size_mm)};
    case 2:
      return {fmt::format("to and fro {:.1f} mm {:.1f} Hz", size_mm, hz), slide(hz, size_mm, 0.0)};
    default:
      return {"still", [](OutgoingFrame& t) { moveTo(t, 10.0); }};
  }
}

/// A disturbance that begins anew `hz` times a second.
NamedAlter drawDisturbance(Random& random) {
  const double hz = drawLog(random, 0.2, 25.0);
  const double share = draw(random, 0.1, 0.6);
  const double size = drawLog(random, 0.5, 15.0);
  const auto turn = [hz](const OutgoingFrame& t) { return std::floor(t.t_s * hz); };
  const auto off = [=](const OutgoingFrame& t) { return t.t_s * hz - turn(t) < share; };
  switch (drawIndex(random, 8)) {
    case 0:
      return {fmt::format("new id {:.1f} Hz", hz),
              [=](OutgoingFrame& t) { t.object().id = 1 + static_cast<std::uint32_t>(turn(t)); }};
    case 1:
      return {fmt::format("absent {:.0f} % {:.1f} Hz", 100.0 * share, hz), [=](OutgoingFrame& t) {
                if (off(t)) t.frame.objects.clear();
              }};
    case 2:
      return {fmt::format("epoch {:.1f} Hz", hz),
              [=](OutgoingFrame& t) { t.frame.epoch = 1 + static_cast<std::uint32_t>(turn(t)); }};
    case 3:
      return {fmt::format("stiffness {:.1f} Hz", hz),
              [=](OutgoingFrame& t) { t.material().stiffness_N_mm = off(t) ? 0.05 : 0.3 * size; }};
    case 4:
      return {fmt::format("silence {:.0f} % {:.1f} Hz", 100.0 * share, hz),
              [=](OutgoingFrame& t) { t.silent = off(t); }};
    case 5:
      return {fmt::format("step {:.1f} mm {:.1f} Hz", size, hz), [=](OutgoingFrame& t) {
                if (!off(t)) return;
                const double height_mm = std::clamp(t.motion().position_mm.z() + size, 0.0, 30.0);
                moveTo(t, height_mm);
              }};
    case 6:
      return {fmt::format("friction {:.1f} Hz", hz),
              [=](OutgoingFrame& t) { t.material().static_friction = off(t) ? 0.0 : 1.5; }};
    default:
      return {fmt::format("acceleration x {:.1f}", size),
              [=](OutgoingFrame& t) { t.motion().acceleration_mm_s2 *= size; }};
  }
}

FalseStream drawOne(Random& random, int number) {
  constexpr std::array kHands = {kHold, kHold, kShallow, kPress, kStroke, ScriptedHand::kTap};
  std::vector<NamedAlter> parts{drawMotion(random)};
  for (int left = 1 + drawIndex(random, 2); left > 0; --left)
    parts.push_back(drawDisturbance(random));
  FalseStream stream;
  stream.name = fmt::format("drawn {}", number);
  for (const NamedAlter& part : parts) stream.name += "; " + part.name;
  stream.hand = kHands[static_cast<std::size_t>(drawIndex(random, kHands.size()))];
  stream.alter = [parts](OutgoingFrame& t) {
    for (const NamedAlter& part : parts) {
      if (!t.frame.objects.empty()) part.alter(t);
    }
  };
  return stream;
}

}  // namespace

std::vector<FalseStream> drawFalseStreams(unsigned seed, int count) {
  Random random(seed);
  std::vector<FalseStream> streams;
  streams.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) streams.push_back(drawOne(random, i));
  return streams;
}

}  // namespace hapticast::testing
