// SPDX-License-Identifier: MIT
#include "client/device/virtual/hand_script.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "tests/support/temp_folder.hpp"
#include "tests/unit/client/complaint.hpp"

namespace hapticast::client {
namespace {

/// A flat object 20 mm high at (30, -10) that may move.
struct Scenery {
  TickReport report;
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 target_mm = {0.0, 0.0, 40.0};
  Vec3 last_velocity_mm_s = Vec3::Zero();
  double fastest_mm_s = 0.0;
  double hardest_mm_s2 = 0.0;

  Scenery() {
    report.time = localTime(5.0);
    report.object_present = report.over_object = true;
    report.object_centre_mm = {30.0, -10.0};
    report.object_centre_height_mm = report.height_at_hip_mm = 20.0;
  }
  void step(HandScript& hand) {
    report.object_velocity_mm_s = velocity_mm_s;
    report.object_centre_mm += velocity_mm_s.head<2>() * 1e-3;
    report.object_centre_height_mm += velocity_mm_s.z() * 1e-3;
    report.time += Duration(1'000'000);
    const Vec3 now_mm = hand.next(report, target_mm);
    const Vec3 v_mm_s = (now_mm - target_mm) * 1e3;
    fastest_mm_s = std::max(fastest_mm_s, v_mm_s.norm());
    hardest_mm_s2 = std::max(hardest_mm_s2, (v_mm_s - last_velocity_mm_s).norm() * 1e3);
    last_velocity_mm_s = v_mm_s;
    target_mm = now_mm;
  }
};

// 1 N over 0.5 and 0.2 N/mm in series.
constexpr double kDepth1N_mm = 7.0;

TEST(HandScript, PressGoesToTheCentrePushesReleasesAndComesAgain) {
  HandScript hand(HandKind::kPress, {});
  Scenery scenery;
  int pushes = 0;
  bool down = false;
  double lowest_mm = 100.0;
  for (int i = 0; i < 12000; ++i) {
    scenery.step(hand);
    const double above_mm = scenery.target_mm.z() - 20.0;
    lowest_mm = std::min(lowest_mm, above_mm);
    if (above_mm < 0.0) {
      EXPECT_LT((scenery.target_mm.head<2>() - Vec2(30.0, -10.0)).norm(), 2.0) << "from above";
    }
    if (!down && above_mm < -6.5) ++pushes, down = true;
    if (above_mm > 8.0) down = false;
  }
  EXPECT_NEAR(lowest_mm, -kDepth1N_mm, 0.05);
  EXPECT_GE(pushes, 3);
  EXPECT_LE(scenery.fastest_mm_s, 301.0);
  EXPECT_LE(scenery.hardest_mm_s2, 5001.0);
}

TEST(HandScript, FollowStaysWithAMovingObject) {
  HandScript hand(HandKind::kFollow, {});
  Scenery scenery;
  for (int i = 0; i < 1000; ++i) scenery.step(hand);
  scenery.velocity_mm_s = {200.0, 0.0, -20.0};
  for (int i = 0; i < 400; ++i) scenery.step(hand);
  EXPECT_LT((scenery.target_mm.head<2>() - scenery.report.object_centre_mm).norm(), 0.5);
  EXPECT_NEAR(scenery.target_mm.z() - scenery.report.object_centre_height_mm, -0.5 * kDepth1N_mm,
              0.1);
  EXPECT_LE(scenery.hardest_mm_s2, 5001.0);
}

TEST(HandScript, SlideMovesOverTheObjectAtTwoCentimetresPerSecond) {
  HandScript hand(HandKind::kSlide, {});
  Scenery scenery;
  for (int i = 0; i < 2000; ++i) scenery.step(hand);
  double way_mm = 0.0;
  double farthest_mm = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 before = scenery.target_mm;
    scenery.step(hand);
    const double step_mm = (scenery.target_mm - before).norm();
    EXPECT_LE(step_mm, 0.0205);
    way_mm += step_mm;
    farthest_mm = std::max(farthest_mm, (scenery.target_mm.head<2>() - Vec2(30.0, -10.0)).norm());
    // 1 mm of surface at 0.5 N/mm and the hand's own spring for the same force.
    EXPECT_NEAR(scenery.target_mm.z(), 20.0 - 3.5, 0.01);
  }
  EXPECT_GT(way_mm, 50.0);
  EXPECT_GT(farthest_mm, 4.0);
  scenery.report.over_object = false;  // a small thing: the figure shrinks until it fits
  for (int i = 0; i < 3000; ++i) scenery.step(hand);
  EXPECT_LT((scenery.target_mm.head<2>() - Vec2(30.0, -10.0)).norm(), 1.5);
}

TEST(HandScript, WaitsAboveAndWithdrawsUpwards) {
  for (const HandKind kind : {HandKind::kPress, HandKind::kSlide, HandKind::kFollow}) {
    HandScript hand(kind, {});
    Scenery scenery;
    for (int i = 0; i < 2500; ++i) scenery.step(hand);
    scenery.report.object_present = false;
    // What sideways speed it had may run out; then it only rises.
    for (int i = 0; i < 100; ++i) scenery.step(hand);
    const Vec2 place_mm = scenery.target_mm.head<2>();
    for (int i = 0; i < 2000; ++i) scenery.step(hand);
    EXPECT_NEAR(scenery.target_mm.z(), 45.0, 0.1);
    EXPECT_LT((scenery.target_mm.head<2>() - place_mm).norm(), 0.1);
    EXPECT_LE(scenery.hardest_mm_s2, 5001.0);
  }
}

TEST(HandScript, AnObjectThatLeapsIsFollowedSmoothly) {
  HandScript hand(HandKind::kFollow, {});
  Scenery scenery;
  for (int i = 0; i < 1000; ++i) scenery.step(hand);
  scenery.report.object_centre_mm = {-60.0, 40.0};  // loop wrap
  for (int i = 0; i < 1500; ++i) scenery.step(hand);
  EXPECT_LT((scenery.target_mm.head<2>() - Vec2(-60.0, 40.0)).norm(), 0.1);
  EXPECT_LE(scenery.fastest_mm_s, 301.0);
  EXPECT_LE(scenery.hardest_mm_s2, 5001.0);
}

std::vector<HandTarget> readTargets(const std::string& text) {
  std::istringstream in(text);
  return readHandTargets(in, "a file");
}
std::string targetsComplaint(const std::string& text) { return complaint(readHandTargets, text); }

TEST(HandScriptFile, IsFollowedLinearly) {
  HandScript hand(HandKind::kFile, {},
                  readTargets("t_s,x_mm,y_mm,z_mm\r\n0.5,0,0,40\n1.5, 10,-20 ,30\n2,10,-20,30\n"));
  Scenery scenery;
  for (int i = 0; i < 1001; ++i) scenery.step(hand);  // the first step is t = 0
  EXPECT_NEAR((scenery.target_mm - Vec3(5.0, -10.0, 35.0)).norm(), 0.0, 1e-9);
  for (int i = 0; i < 5000; ++i) scenery.step(hand);
  EXPECT_EQ(scenery.target_mm, Vec3(10.0, -20.0, 30.0));
  HandScript early(HandKind::kFile, {}, readTargets("0.5,1,2,3"));
  scenery.step(early);
  EXPECT_EQ(scenery.target_mm, Vec3(1.0, 2.0, 3.0));
}

TEST(HandScriptFile, IsReadFromAFile) {
  const TempFolder folder;
  const auto targets = loadHandTargets(folder.write("hand.csv", "0.5,1,2,3\n"));
  ASSERT_EQ(targets.size(), 1U);
  EXPECT_EQ(targets[0].position_mm, Vec3(1.0, 2.0, 3.0));
}

TEST(HandScriptFile, ComplaintsNameTheLine) {
  const std::string row = ": a row is four numbers: t_s,x_mm,y_mm,z_mm";
  EXPECT_EQ(targetsComplaint("0,1,2"), ":1" + row);
  EXPECT_EQ(targetsComplaint("0,1,2,3\n1,1,2,3,4"), ":2" + row);
  EXPECT_EQ(targetsComplaint("0,1,2,3\n1,1,2,x"), ":2" + row);
  EXPECT_EQ(targetsComplaint("0,1,2,3\nt_s,x_mm,y_mm,z_mm"), ":2" + row);
  EXPECT_EQ(targetsComplaint(std::string("0,1,2,3\0,4", 10)), ":1" + row);
  EXPECT_EQ(targetsComplaint("0,1,2,nan"), ":1: a position is not within -1000 to 1000 mm");
  EXPECT_EQ(targetsComplaint("0,1,2000,3"), ":1: a position is not within -1000 to 1000 mm");
  EXPECT_EQ(targetsComplaint("-1,1,2,3"), ":1: t_s is not from 0 to 86400");
  EXPECT_EQ(targetsComplaint("nan,1,2,3"), ":1: t_s is not from 0 to 86400");
  EXPECT_EQ(targetsComplaint("1,1,2,3\n1,1,2,3"), ":2: t_s does not rise");
  EXPECT_EQ(targetsComplaint("0,0,0,0\n" + std::string(500, '1')),
            ":2: longer than 256 characters");
  EXPECT_EQ(targetsComplaint(""), ": no rows of t_s,x_mm,y_mm,z_mm");
  EXPECT_EQ(targetsComplaint("t_s,x_mm,y_mm,z_mm\n"), ": no rows of t_s,x_mm,y_mm,z_mm");
  EXPECT_THROW((void)loadHandTargets("/nonexistent.csv"), std::runtime_error);
  EXPECT_THROW((void)loadHandTargets(::testing::TempDir()), std::runtime_error);
}

}  // namespace
}  // namespace hapticast::client
