// SPDX-License-Identifier: MIT
// What a scene does not need is left out: per object, decided by measurement at the start and as
// the scene changes. A stage goes off only where leaving it out costs less force than the error
// budget. No clock inside: who runs the stages says how long they took. Thread: vision's.
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

struct PlanLine {
  Stage stage = Stage::kSegment;
  bool on = true;
  std::string why;
  double saves_ms = 0.0;  ///< per frame, when it is off, as last measured; 0: it never ran
  double costs_N = 0.0;   ///< rms force, as last measured
};

/// The plan of one object.
class ScenePlan {
 public:
  ScenePlan(const PlanSettings& settings, bool source_mask);

  [[nodiscard]] bool on(Stage stage) const;
  /// Whether the object is at rest: all of it is held. `why`: what released it in this frame, a
  /// text that stays; empty: nothing did.
  void isResting(bool at_rest, std::string_view why = {});
  /// Whether the heights of this frame are those of the last one.
  void unchanged(bool unchanged);
  /// What leaving the stage out costs in this frame: rms force, N; infinity: it cannot be left out.
  void setForceError(Stage stage, double error_N);
  /// What the rigid motion leaves over would be felt as this force in this frame, N. Whether the
  /// grid is worth its bytes: what sways passes through zero, so the last frames count, too.
  bool residual(double force_change_N);
  /// Ends a frame and begins the next one. What is off is measured again every kMeasureEvery
  /// frames.
  void nextFrame();
  [[nodiscard]] bool measureNow() const;
  void addTime(Stage stage, Duration time);

  /// All stages, in order, for --explain.
  [[nodiscard]] std::vector<PlanLine> lines() const;

  // Chosen: once a second at 25 fps; the grid is dear, so it is measured every four seconds, over
  // as many frames as a window of it needs.
  static constexpr int kMeasureEvery = 25;  ///< frames
  static constexpr int kGridEvery = 100;    ///< frames from one measurement of the grid to the next
  static constexpr int kGridFrames = 12;    ///< that one takes

 private:
  [[nodiscard]] std::optional<std::string> whyOff(Stage stage) const;
  [[nodiscard]] std::string explainStage(Stage stage) const;

  PlanSettings settings_;
  bool source_mask_;
  bool at_rest_ = false;
  std::string_view released_;  // what ended the last rest; empty before the first
  bool unchanged_ = false;
  int frame_ = 0;
  std::array<std::optional<double>, kStages> cost_N_{};
  std::array<double, kStages> time_ms_{};
  std::array<double, kStages> this_frame_ms_{};
};

/// Tells a plan how long a stage took, from here to the end of the scope; does nothing without a
/// clock.
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

/// Rms difference of the force that two reliefs of one surface give to a finger 1 mm deep, by the
/// distance to the tangent plane (surface model `normal`), 2 px and more inside their common mask.
/// Requires the same rectangle.
double forceDifference_N(const Relief& a, const Relief& b, double mm_per_px, double stiffness_N_mm);

}  // namespace hapticast::server
