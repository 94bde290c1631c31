// SPDX-License-Identifier: MIT
// Scripted hand: generates the target position of a simulated hand (press, slide, follow, or a
// file). It reads the position of the object from the loop's reports, as a person sees it on the
// screen.
// Thread: loop; the functions that read files: any, before the loop.
#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

enum class HandKind : std::uint8_t { kPress, kSlide, kFollow, kFile };

/// One row of a file with targets.
struct HandTarget {
  double t_s = 0.0;
  Vec3 position_mm = Vec3::Zero();  ///< nominal
};

/// Returns the targets in `file`. The file has rows `t_s,x_mm,y_mm,z_mm` and an optional heading
/// line. Times increase within 0..86400 s, positions lie within ±1000 mm, and there are at most a
/// million rows. Throws std::runtime_error with one line: file and line.
std::vector<HandTarget> loadHandTargets(const std::string& file);
/// Reads targets from the text of a target file. `file` is the file's name for error messages.
/// Throws like loadHandTargets().
std::vector<HandTarget> readHandTargets(std::istream& in, const std::string& file);

/// Stiffnesses from which the hand computes how deep it has to press for a force.
struct HandStiffness {
  double hand_N_mm = 0.2;
  double surface_N_mm = 0.5;
};

class HandScript {
 public:
  /// Only kFile uses `targets`, which then needs at least one row.
  HandScript(HandKind kind, const HandStiffness& stiffness, std::vector<HandTarget> targets = {});

  /// Returns the target of the hand for the next tick, nominal mm. `report` is the report of the
  /// last tick. `start_mm` is the position of the hand, and only the first call uses it.
  ///
  /// A hand of kPress, kSlide or kFollow moves at up to 0.3 m/s relative to the object, with at
  /// most 5 m/s². It follows an object at up to 0.6 m/s. Without an object it waits above the
  /// picture. A hand of kFile moves linearly from row to row.
  Vec3 next(const TickReport& report, const Vec3& start_mm) noexcept;

 private:
  enum class Phase : std::uint8_t { kApproach, kPush, kHold, kRelease };

  Vec3 goal(const TickReport& report) noexcept;
  Vec3 pressGoal(const TickReport& report) noexcept;
  Vec3 slideGoal(const TickReport& report) noexcept;
  double computeDepth_mm(double force_N, double scale) const noexcept;
  void moveTowards(const Vec3& goal_mm, const Vec3& goal_velocity_mm_s) noexcept;
  Vec3 fromFile(double t_s) noexcept;
  void enter(Phase phase) noexcept;

  HandKind kind_;
  HandStiffness stiffness_;
  std::vector<HandTarget> targets_;
  std::size_t row_ = 0;
  bool started_ = false;
  LocalTime begin_{};
  Vec3 target_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
  Phase phase_ = Phase::kApproach;
  int phase_ticks_ = 0;
  double phase_depth_mm_ = 0.0;
  double slide_s_ = 0.0;
  double slide_size_ = 1.0;  // size of the Lissajous figure; shrinks at the edge of the object
};

}  // namespace hapticast::client
