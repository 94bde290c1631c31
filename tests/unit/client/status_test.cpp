// SPDX-License-Identifier: MIT
#include "client/view/status.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

class StatusTest : public ::testing::Test {
 protected:
  StatusTest() {
    ui_state.stream.connected = true;
    report.lookup = Lookup::kInterpolated;
    report.object_present = true;
    report.over_object = true;
    report.height_at_hip_mm = 10.0;
    report.hip_mm = {0.0, 0.0, 22.3};
  }
  void touch(double force_N, std::uint32_t safety_actions = 0) {
    report.contact = true;
    report.static_force_N = {0.0, 0.0, 1.5};
    report.force_N = {0.0, 0.0, force_N};
    report.safety_actions = safety_actions;
  }
  [[nodiscard]] std::string status() const { return statusLine(report, ui_state); }
  [[nodiscard]] std::string hint() const {
    TickStatus ticks;
    ticks.add(report);
    return hintLine(ticks, ui_state);
  }
  /// True if the text states that there is no force, and this remedy.
  [[nodiscard]] bool advises(const std::string& remedy) const {
    return status().find("no force") != std::string::npos &&
           status().find(remedy) != std::string::npos;
  }
  TickReport report;
  UiState ui_state;
};

TEST_F(StatusTest, FilmAndScreenshotHaveTheLineOfTheWindow) {
  EXPECT_EQ(touchLine(report, {}), status());
  touch(1.2);
  EXPECT_EQ(touchLine(report, {}), status());
  report.halt = Halt::kTrustLost;
  EXPECT_EQ(touchLine(report, {}), status());
}

TEST_F(StatusTest, ContactStatesTheForce) {
  touch(1.2);
  EXPECT_EQ(status(), "in contact, 1.2 N");
}

TEST_F(StatusTest, BeforeContactItStatesTheDistanceToTheSurface) {
  EXPECT_EQ(status(), "over the object, 12.3 mm above its surface");
  report.hip_mm.z() = 4.0;
  EXPECT_EQ(status(), "6.0 mm below the surface: lift the tip out of the object");
  report.over_object = false;
  EXPECT_EQ(status(), "beside the object: move the tip over it");
  report.object_present = false;
  EXPECT_EQ(status(), "nothing to touch in this picture: wait for an object");
}

TEST_F(StatusTest, ContactWithoutForceHasAReasonAndARemedy) {
  touch(0.0, bit(SafetyAction::kDisarmed));
  EXPECT_EQ(status(), "in contact, no force: the tip is too deep; lift the tip out of the object");
  touch(0.0, bit(SafetyAction::kFade));
  EXPECT_TRUE(advises("wait")) << status();
  touch(0.0, bit(SafetyAction::kTank));
  EXPECT_TRUE(advises("lift the tip")) << status();
  touch(0.0);
  EXPECT_TRUE(advises("press deeper")) << status();
  ui_state.user.force_factor = 0.0;
  EXPECT_TRUE(advises("in the panel")) << status();
  ui_state.user = {};
  ui_state.user.static_on = false;
  EXPECT_TRUE(advises("press S")) << status();
}

TEST_F(StatusTest, EveryHaltHasAReasonAndARemedy) {
  touch(0.0);
  report.halt = Halt::kTrustLost;
  EXPECT_TRUE(advises("press R")) << status();
  report.halt = Halt::kUnconfirmed;
  EXPECT_TRUE(advises("press R")) << status();
  report.halt = Halt::kDeviceLost;
  report.device = DeviceStatus::kOk;
  EXPECT_TRUE(advises("press R")) << status();
  report.device = DeviceStatus::kLost;
  EXPECT_TRUE(advises("cable")) << status();
}

TEST_F(StatusTest, SafetyStatesHaveALineOfTheirOwn) {
  touch(1.2);
  EXPECT_EQ(stateLines(report), "");
  EXPECT_EQ(stateLines(report, {.connected = true, .picture_reduced = true}),
            "picture reduced: the link is slow");
  report.safety_states = bit(SafetyState::kForceOff);
  EXPECT_EQ(stateLines(report), "") << "the status line states the halt";
  report.safety_states |= bit(SafetyState::kMovesHand) | bit(SafetyState::kLateMachine);
  EXPECT_EQ(stateLines(report), std::string(toText(SafetyState::kMovesHand)) +
                                    " (press R when you have read this)\n" +
                                    toText(SafetyState::kLateMachine));
  EXPECT_EQ(status(), "in contact, 1.2 N");
}

TEST_F(StatusTest, AStaleOrMissingStreamHasAReasonAndARemedy) {
  report.lookup = Lookup::kStale;
  EXPECT_TRUE(advises("wait")) << status();
  ui_state.stream.connected = false;
  EXPECT_TRUE(advises("waits")) << status();
  ui_state.stream.connected = true;
  report.enabled = false;
  EXPECT_TRUE(advises("hold it")) << status();
}

TEST_F(StatusTest, TheFirstScreenShowsTheScanOfTheServer) {
  report.lookup = Lookup::kEmpty;
  ui_state.stream.scan_share = 0.28;
  EXPECT_EQ(status(), "the server scans its clip: 28 % done");
  EXPECT_NE(hint().find("scan"), std::string::npos);
  ui_state.stream.scan_share = 1.0;
  EXPECT_EQ(status(), "waiting for the first frames");
}

TEST_F(StatusTest, AHintExplainsTheFirstTouch) {
  ui_state.pointer_is_device = true;
  EXPECT_EQ(hint(), "Move over the object, turn the wheel down to press. F1: keys and colours.");
  ui_state.pointer_is_device = false;
  EXPECT_EQ(hint().find("wheel"), std::string::npos) << "no wheel moves this device";
  TickStatus ticks;
  ticks.add(report);
  touch(0.5);
  ticks.add(report);
  report.contact = false;
  ticks.add(report);
  EXPECT_EQ(hintLine(ticks, ui_state), "") << "after the first touch";
}

TEST_F(StatusTest, TheChainUsesPlainWords) {
  TickStatus ticks;
  ticks.add(report);
  EXPECT_EQ(ticks.chain(), "no action");
  report.safety_actions = bit(SafetyAction::kSlew) | bit(SafetyAction::kFade);
  ticks.add(report);
  EXPECT_EQ(ticks.chain(), "a step was slowed");
}

}  // namespace
}  // namespace hapticast::client
