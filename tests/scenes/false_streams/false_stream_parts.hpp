// SPDX-License-Identifier: MIT
// Parts of false streams: shapes, waves, grids.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/scenes/false_streams/malicious_server.hpp"
#include "tests/support/flat_relief.hpp"

namespace hapticast::testing {

using FalseStreams = std::vector<FalseStream>;
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kHuge = 3.4e38;
inline constexpr auto kHold = ScriptedHand::kHold;
inline constexpr auto kShallow = ScriptedHand::kShallow;
inline constexpr auto kPress = ScriptedHand::kPress;
inline constexpr auto kBeside = ScriptedHand::kBeside;
inline constexpr auto kStroke = ScriptedHand::kStroke;
inline constexpr auto kRefused = Verdict::kRefused;
inline constexpr auto kLimited = Verdict::kLimited;
inline constexpr auto kTrustLost = Verdict::kTrustLost;
inline constexpr auto kHarmless = Verdict::kHarmless;

inline double square(double t_s, double hz) {
  return std::fmod(t_s * hz + 1e-9, 1.0) < 0.5 ? 1.0 : -1.0;
}
inline double wave(double t_s, double hz, double phase = 0.0) {
  return std::sin(2.0 * std::numbers::pi * hz * t_s + phase);
}

/// The plateau moved by (du, dv) px and to another height.
inline std::shared_ptr<Relief> plate(double height_mm, int du = 0, int dv = 0) {
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

/// The whole plateau at this height, its position with it and, if given, its speed.
inline void moveTo(OutgoingFrame& outgoing, double height_mm, double velocity_mm_s = 0.0) {
  outgoing.setRelief(plate(height_mm));
  outgoing.motion().position_mm.z() = height_mm;
  outgoing.motion().velocity_mm_s.z() = velocity_mm_s;
}

/// Up and down with consistent velocities. It may shake the hand.
inline auto heave(double hz, double amplitude_mm) {
  return [=](OutgoingFrame& t) {
    const double w = 2.0 * std::numbers::pi * hz;
    moveTo(t, 10.0 + amplitude_mm * wave(t.t_s, hz), amplitude_mm * w * std::cos(w * t.t_s));
    t.motion().acceleration_mm_s2.z() = -amplitude_mm * w * w * wave(t.t_s, hz);
  };
}

inline std::shared_ptr<MotionGrid> gridOf(const PixelRect& rect,
                                          const Eigen::Vector3f& velocity_mm_s,
                                          const Eigen::Vector3f& acceleration_mm_s2) {
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = gridCells(rect.width);
  grid->rows = gridCells(rect.height);
  const auto cells = static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
  grid->velocity_mm_s.assign(cells, velocity_mm_s);
  grid->acceleration_mm_s2.assign(cells, acceleration_mm_s2);
  return grid;
}

// The false streams by subject, in the order of falseStreams().
FalseStreams floats();
FalseStreams structure();
FalseStreams slices();
FalseStreams datagrams();
FalseStreams order();
FalseStreams geometry();
FalseStreams motion();
FalseStreams material();

}  // namespace hapticast::testing
