// SPDX-License-Identifier: MIT
#include "client/device/open_device.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

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

TEST(OpenDevice, EveryKindHasANameAndSaysWhatItIs) {
  ASSERT_FALSE(deviceKinds().empty());
  for (const DeviceKind& kind : deviceKinds()) {
    EXPECT_FALSE(std::string(kind.name).empty());
    EXPECT_FALSE(std::string(kind.description).empty());
  }
}

TEST(OpenDevice, AVirtualOneSaysItsProfileAndItsHand) {
  const ManualClock clock;
  const auto device = openDevice("virtual", {.profile = "falcon", .hand = "slide", .clock = clock});
  EXPECT_EQ(device->profile().name, "falcon");
  EXPECT_EQ(device->description(), "virtual device (falcon) in a hand that does: slide");
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
