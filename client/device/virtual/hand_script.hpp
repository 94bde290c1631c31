// SPDX-License-Identifier: MIT
// Where a scripted hand wants to be: press, slide, follow or a file of targets. Reads the reports
// of the room, as a person watches the screen. Thread: the loop's (loading: before it).
#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

enum class HandKind : std::uint8_t { kPress, kSlide, kFollow, kFile };

struct HandTarget {
  double t_s = 0.0;
  Vec3 position_mm = Vec3::Zero();  ///< nominal
};

/// Reads `t_s,x_mm,y_mm,z_mm` rows (a heading line may come first). Times 0..86400 s and rising,
/// positions within
/// +-1000 mm, at most a million rows. Throws std::runtime_error with one line that names file and
/// line.
std::vector<HandTarget> loadHandTargets(const std::string& file);
/// The text of such a file; `file` only names it in complaints.
std::vector<HandTarget> readHandTargets(std::istream& in, const std::string& file);

/// What the hand reckons with when it pushes.
struct HandStiffness {
  double hand_N_mm = 0.2;
  double surface_N_mm = 0.5;
};

class HandScript {
 public:
  /// `targets` only for kFile, not empty then.
  HandScript(HandKind kind, const HandStiffness& stiffness, std::vector<HandTarget> targets = {});

  /// The target of the next tick, nominal mm. Press, slide and follow move at most 0.3 m/s against
  /// the object (which itself is followed up to 0.6 m/s) with at most 5 m/s² and wait above the
  /// picture while there is none; a file is followed as it is, linearly between its rows.
  /// `start_mm`: where the hand is, used at the first call only.
  Vec3 next(const TickReport& report, const Vec3& start_mm) noexcept;

 private:
  enum class Phase : std::uint8_t { kApproach, kPush, kHold, kRelease };

  Vec3 goal(const TickReport& report) noexcept;
  Vec3 pressGoal(const TickReport& report) noexcept;
  Vec3 slideGoal(const TickReport& report) noexcept;
  double depthFor_mm(double force_N, double scale) const noexcept;
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
  double slide_size_ = 1.0;  // of the Lissajous figure, shrinks where it leaves the object
};

}  // namespace hapticast::client
