// SPDX-License-Identifier: MIT
// Scene plan: switches off, for each object, the stages that its scene does not need. A stage is
// off only if the force without the stage would differ by less than the error budget. The plan
// measures this difference at the start, and repeatedly while the scene changes. It has no clock:
// the code that runs the stages reports their durations. Thread: the one that runs Vision.
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

/// State of one stage of a plan, as the flag --explain prints it.
struct PlanLine {
  Stage stage = Stage::kSegment;
  bool on = true;
  std::string why;  ///< reason why the stage is on or off, as text
  /// Last measured duration of the stage in a frame, ms; 0: the stage never ran. While the stage is
  /// off, the server saves this time.
  double saves_ms = 0.0;
  double costs_N = 0.0;  ///< last measured change of force (rms) without the stage
};

/// Measurements of the stages for one object in one frame. The stages return the report, and the
/// tracker adds it to the object's plan.
struct StageReport {
  std::array<Duration, kStages> times{};  ///< durations of the stages
  /// Change of the force in this frame if the stage were off (rms), N. Infinity: the stage must
  /// stay on. nullopt: not measured.
  std::array<std::optional<double>, kStages> costs_N{};
  /// Whether the object's heights equal those in the last frame; nullopt: not measured.
  std::optional<bool> unchanged;
};

/// Plan of one object: decides in each frame which stages are on.
class ScenePlan {
 public:
  /// Copies `settings`. `source_mask`: whether the source delivers masks.
  ScenePlan(const PlanSettings& settings, bool source_mask);

  /// Returns whether the stage runs in this frame.
  [[nodiscard]] bool isOn(Stage stage) const;
  /// Sets whether the whole object is at rest in this frame. `why`: if the object begins to move in
  /// this frame, the cause as a static text; otherwise empty.
  void setResting(bool at_rest, std::string_view why = {});
  /// Adds the measurements of the stages. Durations add up over a frame. A cost replaces the
  /// earlier one.
  void add(const StageReport& report);
  /// Ends the present frame and begins the next one.
  void nextFrame();
  /// Returns whether this frame measures the costs of kClean and kSmooth, whether they are on or
  /// off. It is true every kMeasureEvery frames.
  [[nodiscard]] bool measureNow() const;

  /// Returns the state of all stages, in the order of Stage, for the flag --explain.
  [[nodiscard]] std::vector<PlanLine> lines() const;

  // The value is a choice: stages that are off are measured once a second at 25 fps. The grid is
  // expensive, so it is measured every four seconds, over as many frames as its window needs.
  static constexpr int kMeasureEvery =
      25;  ///< frames between two measurements of a stage that is off
  static constexpr int kGridEvery = 100;  ///< frames between two measurements of the grid
  static constexpr int kGridFrames = 12;  ///< frames of one measurement of the grid

 private:
  [[nodiscard]] std::optional<std::string> explainOff(Stage stage) const;
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

/// Measures the time from its construction to its destruction and adds it to a report as the
/// duration of a stage. Does nothing if `clock` is null.
class ScopedStageTimer {
 public:
  ScopedStageTimer(const Clock* clock, StageReport& report, Stage stage)
      : clock_(clock),
        time_(report.times[static_cast<std::size_t>(stage)]),
        start_(clock != nullptr ? clock->now() : LocalTime()) {}
  ~ScopedStageTimer() {
    if (clock_ != nullptr) time_ += clock_->now() - start_;
  }
  ScopedStageTimer(const ScopedStageTimer&) = delete;
  ScopedStageTimer& operator=(const ScopedStageTimer&) = delete;

 private:
  const Clock* clock_;
  Duration& time_;
  LocalTime start_;
};

/// Returns the difference (rms) of the forces that two reliefs of one surface cause at a finger 1
/// mm deep in the surface, N. It compares the forces at all pixels at least 2 px inside the common
/// mask. The force is proportional to the distance to the surface's tangent plane. Returns infinity
/// if there is no such pixel. Requires equal rectangles.
double forceDifference_N(const Relief& a, const Relief& b, double mm_per_px, double stiffness_N_mm);

}  // namespace hapticast::server
