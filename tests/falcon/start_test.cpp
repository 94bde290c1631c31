// SPDX-License-Identifier: MIT
// From the plug to a grip that pushes back, and everything that may stand in the way.
#include <sys/stat.h>
#include <unistd.h>

#include "tests/falcon/falcon_fixture.hpp"

namespace hapticast::testing {
namespace {

class FalconStart : public FalconTest {};

TEST_F(FalconStart, OneThatRunsIsHomedByTheHandAndPushesBack) {
  bootAndPlugIn();
  const auto device = openFalcon();
  EXPECT_EQ(device->description(),
            "falcon (falcon, serial number FT0TEST1) in a process of its own");
  Turning turning(*device, clock_);
  turning.push(1.0);
  EXPECT_TRUE(turning.runsAgain());
  EXPECT_TRUE(waitUntil(kPatience, [&] { return received().back().request.motors != kNoTorque; }));
  turning.stop();
  const auto all = received();
  for (const ReceivedRequest& each : all) {
    EXPECT_TRUE(each.request.homing);
    if (each.request.motors != kNoTorque) {
      ASSERT_EQ(each.request.lights, client::FalconLight::kGreen);
    }
  }
  EXPECT_EQ(all.front().request.motors, kNoTorque);
  EXPECT_GT(device->traffic()->round_trips, 100U);
}

TEST_F(FalconStart, TheFirmwareIsLoadedOverAShakyStart) {
  port_->with([](FalconModel& model, BusFaults&) {
    model.faults.hellos_ignored = 3;
    model.faults.echoes_wrong = 1;
  });
  port_->plugIn();
  file_ = firmwareFile();
  const auto device = openFalcon();
  EXPECT_TRUE(port_->with([](FalconModel& model, BusFaults&) { return model.runs(); }));
  EXPECT_NE(logged_.find("loading its firmware (2000 bytes)"), std::string::npos) << logged_;
  EXPECT_NE(logged_.find("received other bytes"), std::string::npos) << logged_;
  EXPECT_NE(logged_.find("% of its firmware is loaded"), std::string::npos) << logged_;
}

TEST_F(FalconStart, SlowFirmwareAndASlowBootLoaderStart) {
  file_ = firmwareFile();
  for (const int ms : {20, 60, 150, 400}) {
    SCOPED_TRACE(ms);
    port_->with([ms](FalconModel& model, BusFaults&) {
      model.powerCycle();
      model.faults.start_delay = std::chrono::milliseconds(ms);
      model.faults.loader_delay = std::chrono::milliseconds(ms == 400 ? 500 : 0);
    });
    port_->plugIn();
    EXPECT_TRUE(openFalcon() != nullptr) << logged_;
    port_->unplug();
  }
}

TEST_F(FalconStart, OneThatIsNotThere) {
  EXPECT_EQ(complaint(),
            "--device falcon: none was found on USB: is it plugged in, and its power supply too?");
  EXPECT_TRUE(client::findDevice(request()) == nullptr);
  EXPECT_NE(client::listDevices(request()).find("none was found"), std::string::npos);
}

TEST_F(FalconStart, OneThatIsFoundByItself) {
  bootAndPlugIn();
  EXPECT_NE(client::listDevices(request()).find("serial number FT0TEST1"), std::string::npos);
  EXPECT_TRUE(client::findDevice(request()) != nullptr);
}

TEST_F(FalconStart, OneThatBelongsToAnother) {
  bootAndPlugIn();
  port_->with([](FalconModel&, BusFaults& bus) { bus.busy = true; });
  EXPECT_EQ(complaint(),
            "--device falcon: another program uses the device: end that program first");
  EXPECT_NE(client::listDevices(request()).find("another program"), std::string::npos);
}

TEST_F(FalconStart, OneThatMayNotBeOpened) {
  bootAndPlugIn();
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody without the permission";
  port_->forbid();
  ASSERT_EQ(seteuid(65534), 0);
  // In this process: the loader ignores the preload library in a child with another effective user.
  std::string line;
  try {
    const client::FalconUsb usb("");
  } catch (const client::FalconError& error) {
    line = error.what();
  }
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_NE(line.find("no permission to open it: copy deploy/70-hapticast-falcon.rules"),
            std::string::npos)
      << line;
}

TEST_F(FalconStart, AnotherSerialNumber) {
  bootAndPlugIn();
  try {
    auto another = request();
    another.options["falcon.serial"] = "FTOTHER";
    (void)client::openDevice("falcon", another);
    ADD_FAILURE();
  } catch (const client::DeviceAbsent& error) {
    EXPECT_STREQ(
        error.what(),
        "--device falcon: the connected device has the serial number FT0TEST1, not FTOTHER");
  }
}

TEST_F(FalconStart, FirmwareThatIsNone) {
  port_->plugIn();
  EXPECT_NE(complaint().find("name the file with --falcon-firmware FILE"), std::string::npos);
  file_ = "/nowhere.bin";
  EXPECT_EQ(complaint(), "--falcon-firmware /nowhere.bin: cannot be read");
  file_ = firmwareFile({});
  EXPECT_EQ(complaint(), "--falcon-firmware " + file_ + ": is empty");
  file_ = firmwareFile(std::vector<std::uint8_t>(70'000));
  EXPECT_NE(complaint().find("longer than 64 KiB"), std::string::npos);
  // Of the right length, but another one.
  file_ = firmwareFile(std::vector<std::uint8_t>(2000, 7));
  EXPECT_NE(complaint().find("the device does not run with this firmware: is it the right file?"),
            std::string::npos);
}

}  // namespace
}  // namespace hapticast::testing
