// SPDX-License-Identifier: MIT
// How things of a scene move: sums of smooth moves and turns with exact velocities. Thread: any;
// values.
#pragma once

#include <cmath>
#include <vector>

#include "tests/scenes/held/solid.hpp"

namespace hapticast::evaluate::held {

/// From 0 before `begin_s` to 1 after `end_s` with the least jerk, as hands move.
struct Ease {
  double begin_s = 0.0;
  double end_s = 1.0;

  [[nodiscard]] double at(double t) const {
    const double u = share(t);
    return u * u * u * (10.0 + u * (6.0 * u - 15.0));
  }
  [[nodiscard]] double rate(double t) const {
    const double u = share(t);
    return 30.0 * u * u * (1.0 - u) * (1.0 - u) / (end_s - begin_s);
  }

 private:
  [[nodiscard]] double share(double t) const {
    return std::fmin(1.0, std::fmax(0.0, (t - begin_s) / (end_s - begin_s)));
  }
};

/// A number that changes by eased steps.
class Ramp {
 public:
  Ramp& step(const Ease& when, double by) {
    steps_.push_back({when, by});
    return *this;
  }
  [[nodiscard]] double at(double t) const {
    double sum = 0.0;
    for (const Step& step : steps_) sum += step.by * step.when.at(t);
    return sum;
  }
  [[nodiscard]] bool changes() const { return !steps_.empty(); }
  [[nodiscard]] double rate(double t) const {
    double sum = 0.0;
    for (const Step& step : steps_) sum += step.by * step.when.rate(t);
    return sum;
  }

 private:
  struct Step {
    Ease when;
    double by;
  };
  std::vector<Step> steps_;
};

struct MotionState {
  Pose pose;
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 turning_rad_s = Vec3::Zero();

  /// Of a point of the body that is at `at_mm` now.
  [[nodiscard]] Vec3 velocityAt(const Vec3& at_mm) const {
    return velocity_mm_s + turning_rad_s.cross(at_mm - pose.at_mm);
  }
};

/// A body's way: it begins at a pose; moves add up, turns follow each other about axes that stand.
class Path {
 public:
  Path() = default;
  explicit Path(const Pose& begin) : begin_(begin) {}

  Path& move(const Ease& when, const Vec3& by_mm) {
    moves_.push_back({when, by_mm});
    return *this;
  }
  Path& turn(const Ease& when, const Vec3& axis, double by_rad) {
    turns_.push_back({when, axis.normalized(), by_rad});
    return *this;
  }
  [[nodiscard]] MotionState at(double t) const;
  /// The same way in the frame that `outer` places this one in.
  [[nodiscard]] Path in(const Pose& outer) const;

 private:
  struct Move {
    Ease when;
    Vec3 by_mm;
  };
  struct Turn {
    Ease when;
    Vec3 axis;
    double by_rad;
  };
  Pose begin_;
  std::vector<Move> moves_;
  std::vector<Turn> turns_;
};

inline MotionState Path::at(double t) const {
  MotionState out;
  out.pose = begin_;
  for (const Move& move : moves_) {
    out.pose.at_mm += move.when.at(t) * move.by_mm;
    out.velocity_mm_s += move.when.rate(t) * move.by_mm;
  }
  for (const Turn& turn : turns_) {
    const Mat3 by = Eigen::AngleAxisd(turn.by_rad * turn.when.at(t), turn.axis).toRotationMatrix();
    out.pose.turn = by * out.pose.turn;
    out.turning_rad_s = by * out.turning_rad_s + turn.by_rad * turn.when.rate(t) * turn.axis;
  }
  return out;
}

inline Path Path::in(const Pose& outer) const {
  Path out(outer * begin_);
  for (const Move& move : moves_) out.move(move.when, outer.turn * move.by_mm);
  for (const Turn& turn : turns_) out.turn(turn.when, outer.turn * turn.axis, turn.by_rad);
  return out;
}

}  // namespace hapticast::evaluate::held
