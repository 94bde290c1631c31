// SPDX-License-Identifier: MIT
// The force at the viewer when one frame changes the mask, the id or the layer of the object that
// the hand presses on, as a timed correction of the author does. The bytes of each frame go through
// the receiver, the renderer and the safety chain to a virtual device, in virtual time.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/scenes/false_streams/run_false_stream.hpp"
#include "tests/support/flat_relief.hpp"

namespace hapticast::client {
namespace {

constexpr std::uint64_t kCorrectedFrame = 45;
constexpr std::size_t kCorrected_ticks = 40 * kCorrectedFrame;  // at 25 frames a second
constexpr double kEnd_s = 3.0;
constexpr double kPressed_N = 0.3;  // a pressed tip has a larger force
constexpr SurfaceKind kSurfaces[] = {SurfaceKind::kProxy, SurfaceKind::kNormal,
                                     SurfaceKind::kPerturbed};

/// A plateau in the middle of the picture, whole, or without the part from 5 mm left of the middle.
std::shared_ptr<const Relief> plateau(bool whole) {
  auto relief = flatRelief(testing::kPlateau_px, testing::kPlateau_mm);
  constexpr int kWidth_px = testing::kPlateau_px.width;
  for (std::size_t i = 0; !whole && i < relief->mask.size(); ++i) {
    if (static_cast<int>(i) % kWidth_px >= kWidth_px / 3) relief->mask[i] = 0;
  }
  return relief;
}

/// The change of the corrected frame under the hand.
struct Correction {
  const char* name;
  bool whole_before = true;
  bool whole_after = true;
  bool remains = true;  ///< false: no object after it
  std::uint32_t id = 1;
  std::uint32_t layer = 0;

  void apply(HapticFrame& frame) const {
    static const std::shared_ptr<const Relief> kReliefs[] = {plateau(false), plateau(true)};
    const bool corrected = frame.id >= kCorrectedFrame;
    HapticObject& object = frame.objects.front();
    object.relief = kReliefs[(corrected ? whole_after : whole_before) ? 1 : 0];
    object.changed_in_frame = corrected ? kCorrectedFrame : 0;
    object.id = corrected ? id : 1;
    object.layer = corrected ? layer : 0;
    if (corrected && !remains) frame.objects.clear();
  }
};

constexpr Correction kCorrections[] = {{.name = "mask_loses_the_tip", .whole_after = false},
                                       {.name = "mask_gains_the_tip", .whole_before = false},
                                       {.name = "another_id_at_the_same_place", .id = 2},
                                       {.name = "lost_without_another", .remains = false},
                                       {.name = "another_layer", .layer = 1}};

/// The viewer's force trace.
struct CorrectedRun {
  ForceTrace trace;  ///< its steps are those since the corrected frame was sent
  std::vector<double> forces_N;
  TickReport last;
};

/// A light hand wants to be 6 mm below the plateau. With `nail_mm` the tip cannot leave that
/// height.
CorrectedRun renderTrace(const Correction& correction, SurfaceKind surface,
                         std::optional<double> nail_mm = std::nullopt) {
  testing::FalseStream stream;
  stream.name = correction.name;
  stream.alter = [&](testing::OutgoingFrame& outgoing) { correction.apply(outgoing.frame); };
  testing::MaliciousServer server(stream);
  RendererSettings settings;
  settings.surface = surface;
  const HandScript hold = handOf(testing::ScriptedHand::kHold);
  VirtualViewer viewer(settings, PlantProfile{}, Hand::light(), nail_mm ? nullptr : &hold);
  if (nail_mm) viewer.nail({0.1, 0.1, *nail_mm});
  CorrectedRun run;
  run.last = runSession(server, viewer, kEnd_s, [&](const TickReport& report) {
    run.forces_N.push_back(report.force_N.norm());
    if (run.forces_N.size() > kCorrected_ticks) return;
    ForceTrace& trace = viewer.trace;
    trace.max_rise_N = trace.max_fall_N = trace.max_unexplained_N = trace.step_excess_N = 0.0;
  });
  run.trace = std::move(viewer.trace);
  return run;
}

void expectForce(bool pressed, double force_N) {
  if (pressed) {
    EXPECT_GT(force_N, kPressed_N);
  } else {
    EXPECT_EQ(force_N, 0.0);
  }
}

/// Checks what holds for every hand. Both meters leave out the part of a step that the hand made.
void expectNoStep(const Correction& correction, const CorrectedRun& run) {
  EXPECT_EQ(run.trace.refused + run.trace.rejected, 0U);
  EXPECT_TRUE(run.trace.finite);
  EXPECT_EQ(run.trace.step_excess_N, 0.0);
  EXPECT_LE(run.trace.max_unexplained_N, DeviceProfile{}.slew_fall_N_per_tick + 1e-9);
  EXPECT_EQ(run.last.halt, Halt::kNone);
  expectForce(correction.whole_before, run.forces_N[kCorrected_ticks - 1]);
  expectForce(correction.whole_after && correction.remains, run.forces_N.back());
}

class CorrectedMaskTest : public ::testing::TestWithParam<Correction> {};

TEST_P(CorrectedMaskTest, APressedTipGetsNoStepOfTheForce) {
  for (const SurfaceKind surface : kSurfaces) {
    SCOPED_TRACE(static_cast<int>(surface));
    expectNoStep(GetParam(), renderTrace(GetParam(), surface));
  }
}

TEST_P(CorrectedMaskTest, UnderATipThatCannotMoveTheForceKeepsTheSlewLimit) {
  const DeviceProfile profile;
  for (const SurfaceKind surface : kSurfaces) {
    for (const double nail_mm : {8.0, 5.0}) {  // 2 and 5 mm below the plateau
      SCOPED_TRACE(std::to_string(static_cast<int>(surface)) + " " + std::to_string(nail_mm));
      const CorrectedRun run = renderTrace(GetParam(), surface, nail_mm);
      expectNoStep(GetParam(), run);
      EXPECT_LE(run.trace.max_rise_N, profile.slew_rise_N_per_tick + 1e-9);
      EXPECT_LE(run.trace.max_fall_N, profile.slew_fall_N_per_tick + 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Corrections, CorrectedMaskTest, ::testing::ValuesIn(kCorrections),
                         [](const auto& at) { return std::string(at.param.name); });

}  // namespace
}  // namespace hapticast::client
