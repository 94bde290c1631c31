// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"
#include "client/haptics/tick_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "common/time.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

std::string complaintOf(const std::string& kind, const DeviceRequest& request) {
  try {
    (void)openDevice(kind, request);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(OpenDevice, EveryKindHasANameAndADescription) {
  ASSERT_FALSE(deviceKinds().empty());
  for (const DeviceKind& kind : deviceKinds()) {
    EXPECT_FALSE(std::string(kind.name).empty());
    EXPECT_FALSE(std::string(kind.description).empty());
  }
}

TEST(OpenDevice, AVirtualOneReportsItsProfileAndItsHand) {
  const ManualClock clock;
  const auto device = openDevice("virtual", {.profile = "falcon", .hand = "slide", .clock = clock});
  EXPECT_EQ(device->profile().name, "falcon");
  EXPECT_EQ(device->description(), "virtual device (falcon) in a hand that does: slide");
}

/// Returns how far the hand goes aside from the middle of an object, nominal mm.
double reachOf(const char* hand) {
  ManualClock clock;
  const auto device = openDevice("virtual", {.hand = hand, .clock = clock});
  TickReport report;
  report.mapping = DeviceMapping::fit(Workspace{}, device->profile().workspace_mm);
  report.object_present = report.over_object = true;
  report.object_centre_mm = {10.0, 5.0};
  report.object_centre_height_mm = report.height_at_hip_mm = 12.0;
  double reach_mm = 0.0;
  for (int i = 0; i < 6000; ++i) {
    clock.advance(kTickPeriod);
    report.time = clock.now();
    ++report.tick;
    report.hip_mm = report.mapping.toNominal(device->exchange(Vec3::Zero(), report).position_mm);
    const Vec2 aside_mm = report.hip_mm.head<2>() - report.object_centre_mm;
    if (i > 3000) reach_mm = std::max(reach_mm, aside_mm.norm());
  }
  return reach_mm;
}

TEST(OpenDevice, AVirtualHandFollowsTheScriptOfItsName) {
  EXPECT_LT(reachOf("press"), 0.5);
  EXPECT_LT(reachOf("follow"), 0.5);
  EXPECT_GT(reachOf("slide"), 3.0);
}

TEST(OpenDevice, AutoIsTheBestKindThereIs) {
  const ManualClock clock;
  const auto device = openDevice("auto", {.clock = clock});
  EXPECT_EQ(device->description(),
            openDevice(deviceKinds().front().name, {.clock = clock})->description());
}

TEST(OpenDevice, AutoIsTheMouseWhereThereIsAWindow) {
  const ManualClock clock;
  LatestValue<PointerTarget> pointer;
  const auto device = openDevice("auto", {.clock = clock, .pointer = &pointer});
  EXPECT_EQ(device->description(), "mouse: a virtual device (omni) on a spring behind the pointer");
}

TEST(OpenDevice, TheListNamesEveryKind) {
  const ManualClock clock;
  const std::string list = listDevices({.clock = clock});
  for (const DeviceKind& kind : deviceKinds())
    EXPECT_NE(list.find(std::string(kind.name) + ": "), std::string::npos) << list;
}

TEST(OpenDevice, ComplaintsNameTheFlag) {
  const ManualClock clock;
  const std::string unknown = complaintOf("spoon", {.clock = clock});
  EXPECT_EQ(unknown.find("--device spoon: is not one of auto|virtual|mouse"), 0U) << unknown;
  EXPECT_EQ(complaintOf("mouse", {.clock = clock}),
            "--device mouse: needs the window to point in (--view on)");
  EXPECT_EQ(
      complaintOf("virtual", {.profile = "/nowhere", .clock = clock}).find("--profile /nowhere: "),
      0U);
  EXPECT_EQ(complaintOf("virtual", {.hand = "/nowhere.csv", .clock = clock})
                .find("--hand /nowhere.csv: "),
            0U);
}

}  // namespace
}  // namespace hapticast::client
