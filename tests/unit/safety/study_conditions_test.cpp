// SPDX-License-Identifier: MIT
// Every change from one condition of a study to another one, while a hand presses on: the stream
// ends, the force fades, the controls change, another stream begins (TrialPlayer::play()). The
// plant is that of press_bench.hpp.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/press_bench.hpp"

namespace hapticast::client {
namespace {

constexpr double kTrial_s = 1.5;

std::vector<UserControls> listConditions() {
  std::vector<UserControls> list(9);
  list[1].stiffness_factor = 0.2;
  list[2].stiffness_factor = 3.0;
  list[3].mass_kg = 4.0;
  list[4].static_on = false;
  list[5].dynamic_on = false;
  list[6].method = Method::kThesis;
  list[6].surface = SurfaceKind::kPerturbed;
  list[7].surface = SurfaceKind::kNormal;
  list[8].paused = true;
  return list;
}

/// A hand in a study. It presses all the time.
class StudyConditions : public ::testing::Test {
 protected:
  /// The plate moves up and down by 2 mm, once in a second.
  void movePlate() {
    bench.scene = [this](PlayFrame& frame, double t_s) {
      constexpr double kRate = 2.0 * M_PI;
      const double phase = kRate * t_s;
      const double height_mm = PressBench::kPlate_mm + 2.0 * std::sin(phase);
      // Rounded: the bench stores a surface for each height.
      PlayObject& object = bench.add(frame, 1, 1e-3 * std::round(1e3 * height_mm));
      object.motion.velocity_mm_s.z() = 2.0 * kRate * std::cos(phase);
      object.motion.acceleration_mm_s2.z() = -2.0 * kRate * kRate * std::sin(phase);
    };
  }
  void run(double seconds) {
    const double end_s = bench.time_s + seconds;
    while (bench.time_s < end_s) {
      const TickReport& report = bench.step();
      excess_N = std::max(excess_N, report.step_excess_N);
      last_N = report.force_N.norm();
      force_N = std::max(force_N, last_N);
    }
  }
  /// Ends the stream. Returns after the force is zero.
  void endStream() {
    bench.stream.connected = bench.streaming = false;
    for (int i = 0; i < 2000 && (i == 0 || last_N > 0.0); ++i) run(0.001);
    EXPECT_EQ(last_N, 0.0);
  }
  void beginStream(const UserControls& condition) {
    const UserControls before = bench.user;
    bench.user = condition;
    bench.user.number = before.number + 1;
    bench.user.stop = before.stop;
    bench.user.rearm = before.rearm;
    bench.stream.first_epoch = ++bench.epoch;
    ++bench.stream.number;
    bench.stream.connected = bench.streaming = true;
  }
  PressBench bench{PressSetup{}};
  double excess_N = 0.0;
  double last_N = 0.0;
  double force_N = 0.0;  // largest since a test reset it
};

TEST_F(StudyConditions, NoChangeStepsOrDrivesThePressingHand) {
  run(2.0);
  const auto conditions = listConditions();
  double most_mJ = 0.0;
  int touched = 0;
  for (std::size_t from = 0; from < conditions.size(); ++from) {
    for (std::size_t to = 0; to < conditions.size(); ++to) {
      if (from == to) continue;
      endStream();
      beginStream(conditions[from]);
      run(kTrial_s);
      const double begin_s = bench.time_s;
      endStream();
      beginStream(conditions[to]);
      force_N = 0.0;
      run(kTrial_s);
      touched += force_N > 0.05 ? 1 : 0;
      const double work_mJ = bench.mostWork_mJ(begin_s, 10.0);
      EXPECT_LE(work_mJ, 10.0) << from << " to " << to;
      most_mJ = std::max(most_mJ, work_mJ);
    }
  }
  EXPECT_EQ(excess_N, 0.0);
  EXPECT_TRUE(bench.finite);
  EXPECT_GT(touched, 36) << "changes after which a force acted";
  RecordProperty("most_mJ", std::to_string(most_mJ));
  std::printf("step excess %g N, most work on the hand at a change %.2f mJ\n", excess_N, most_mJ);
}

TEST_F(StudyConditions, NoChangeStepsOnAMovingObject) {
  movePlate();
  run(2.0);
  for (int round = 0; round < 3; ++round) {
    for (const UserControls& condition : listConditions()) {
      endStream();
      beginStream(condition);
      run(kTrial_s);
    }
  }
  EXPECT_EQ(excess_N, 0.0);
  EXPECT_GT(force_N, 0.5);
}

TEST_F(StudyConditions, AChangeDuringContactStepsNeitherAndDrivesNoHand) {
  run(2.0);
  for (const UserControls& condition : listConditions()) {
    const double begin_s = bench.time_s;
    beginStream(condition);
    run(kTrial_s);
    EXPECT_LE(bench.mostWork_mJ(begin_s, 10.0), 10.0);
  }
  EXPECT_EQ(excess_N, 0.0);
}

TEST_F(StudyConditions, TheStopKeyZeroesTheForceUntilTheSubjectGoesOn) {
  run(2.0);
  ASSERT_GT(last_N, 0.3);
  ++bench.user.stop;
  int ticks = 0;
  while (last_N > 0.0 && ticks < 1000) {
    run(0.001);
    ++ticks;
  }
  EXPECT_LE(ticks, 50) << "ms until the force is zero";
  force_N = 0.0;
  run(2.0);
  EXPECT_EQ(force_N, 0.0);
  EXPECT_EQ(bench.renderer->report().halt, Halt::kStopped);
  ++bench.user.rearm;
  run(2.0);
  EXPECT_GT(last_N, 0.3);
  EXPECT_EQ(excess_N, 0.0);
}

TEST_F(StudyConditions, TheMassOfAConditionReplacesTheAuthorsOne) {
  movePlate();
  const auto measure = [this](double mass_kg) {
    bench.user.mass_kg = mass_kg;
    run(2.0);
    double most_N = 0.0;
    for (int i = 0; i < 2000; ++i) most_N = std::max(most_N, bench.step().dynamic_force_N.norm());
    return most_N;
  };
  const double light_N = measure(0.5);
  EXPECT_GT(light_N, 0.02);
  EXPECT_NEAR(measure(1.5) / light_N, 3.0, 0.3);
}

}  // namespace
}  // namespace hapticast::client
