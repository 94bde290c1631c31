// SPDX-License-Identifier: MIT
// Scene plan: switches off, for each object, the stages that its scene does not need. A stage is
// off only if its omission changes the force by less than the error budget.
// The plan measures at the start and repeatedly while the scene changes. It has no clock: the code
// that runs the stages reports their durations. Thread: the one that runs Vision.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/haptic_frame.hpp"
#include "common/time.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// State of one stage of a plan, for --explain.
struct PlanLine {
  Stage stage = Stage::kSegment;
  bool on = true;
  std::string why;        ///< the reason, as text
  double saves_ms = 0.0;  ///< saved time per frame while off, as last measured; 0: it never ran
  double costs_N = 0.0;   ///< rms change of force by the omission, as last measured
};

/// The plan of one object.
class ScenePlan {
 public:
  /// Copies `settings`. `source_mask`: the source has masks.
  ScenePlan(const PlanSettings& settings, bool source_mask);

  /// Returns whether the stage runs in this frame.
  [[nodiscard]] bool on(Stage stage) const;
  /// Sets whether all of the object is held at rest. `why`: cause of the release in this frame,
  /// static text; empty: no release.
  void setResting(bool at_rest, std::string_view why = {});
  /// Sets whether the heights of this frame equal those of the last frame.
  void setUnchanged(bool unchanged);
  /// Sets the rms change of force by the stage's omission in this frame, N. Infinity: it cannot be
  /// off.
  void setForceError(Stage stage, double error_N);
  /// Adds the force that the residual motion causes in this frame, N. Returns whether the grid is
  /// worth its bytes. The last frames count too, because oscillations pass through zero.
  bool addResidual(double force_change_N);
  /// Ends a frame and begins the next frame. Stages that are off are measured again every
  /// kMeasureEvery frames.
  void nextFrame();
  /// Returns whether stages that are off are measured in this frame.
  [[nodiscard]] bool measureNow() const;
  /// Adds `time` to the stage's duration in this frame.
  void addTime(Stage stage, Duration time);

  /// Returns all stages, in order, for --explain.
  [[nodiscard]] std::vector<PlanLine> lines() const;

  // Chosen: once a second at 25 fps. The grid is expensive, so it is measured every four seconds,
  // over as many frames as its window needs.
  static constexpr int kMeasureEvery = 25;  ///< frames
  static constexpr int kGridEvery = 100;    ///< frames between two measurements of the grid
  static constexpr int kGridFrames = 12;    ///< frames of one measurement of the grid

 private:
  [[nodiscard]] std::optional<std::string> whyOff(Stage stage) const;
  [[nodiscard]] std::string explainStage(Stage stage) const;

  PlanSettings settings_;
  bool source_mask_;
  bool at_rest_ = false;
  std::string_view released_;  // cause of the last release; empty before the first
  bool unchanged_ = false;
  int frame_ = 0;
  std::array<std::optional<double>, kStages> cost_N_{};
  std::array<double, kStages> time_ms_{};
  std::array<double, kStages> this_frame_ms_{};
};

/// Reports the duration of a stage to a plan, from construction to destruction. Does nothing if
/// `clock` is null.
class ScopedStageTimer {
 public:
  ScopedStageTimer(const Clock* clock, ScenePlan& plan, Stage stage)
      : clock_(clock),
        plan_(plan),
        stage_(stage),
        start_(clock != nullptr ? clock->now() : LocalTime()) {}
  ~ScopedStageTimer() {
    if (clock_ != nullptr) plan_.addTime(stage_, clock_->now() - start_);
  }
  ScopedStageTimer(const ScopedStageTimer&) = delete;
  ScopedStageTimer& operator=(const ScopedStageTimer&) = delete;

 private:
  const Clock* clock_;
  ScenePlan& plan_;
  Stage stage_;
  LocalTime start_;
};

/// Returns the rms difference of the forces that two reliefs of one surface exert on a finger 1 mm
/// deep, N. The force follows the distance to the tangent plane (surface model `normal`).
/// Uses pixels at least 2 px inside the common mask; infinity if there are none. Requires equal
/// rectangles.
double forceDifference_N(const Relief& a, const Relief& b, double mm_per_px, double stiffness_N_mm);

}  // namespace hapticast::server
