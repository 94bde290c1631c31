// SPDX-License-Identifier: MIT
// A port with a Falcon, and the client's device on it. Real time: everything waits for conditions.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "client/device/falcon/falcon_link.hpp"
#include "client/device/open_device.hpp"
#include "client/haptics/tick_report.hpp"
#include "tests/falcon/usb_port.hpp"
#include "tests/support/checked_devices.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing {

inline constexpr std::chrono::seconds kPatience{30};
inline constexpr std::array<int, 3> kNoTorque{0, 0, 0};

inline std::vector<std::uint8_t> someFirmware(std::size_t size = 2000) {
  std::mt19937 random(11);
  std::vector<std::uint8_t> bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

class FalconTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasUmockdev()) GTEST_SKIP() << "umockdev's preload library was not found";
    port_ = std::make_unique<UsbPort>(someFirmware());
  }

  std::string firmwareFile(const std::vector<std::uint8_t>& bytes = someFirmware()) {
    return folder_.write("firmware.bin", std::string(bytes.begin(), bytes.end()));
  }
  void bootAndPlugIn() {
    port_->with([](FalconModel& model, BusFaults&) { model.boot(); });
    port_->plugIn();
  }
  client::DeviceRequest request() {
    return {.clock = clock_,
            .options = {{"falcon.firmware", file_}},
            .helper_program = HAPTICAST_DEVICE_PROGRAM,
            .log = [this](const std::string& line) { logged_.append(line).append("\n"); }};
  }
  std::unique_ptr<client::HapticDevice> openFalcon() {
    return client::openDevice("falcon", request());
  }
  std::string complaint() {
    try {
      (void)openFalcon();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  /// Commands that the motors received, newest last.
  std::vector<ReceivedRequest> received() {
    return port_->with([](FalconModel& model, BusFaults&) { return model.received(); });
  }
  /// The motors' last word is zero, and was not always.
  void expectZeroAtLast() {
    const auto all = received();
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.back().request.motors, kNoTorque);
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const ReceivedRequest& each) {
      return each.request.motors != kNoTorque;
    }));
  }

  SteadyClock clock_;
  TempFolder folder_;
  StateFolder state_{folder_ / "state"};
  std::unique_ptr<UsbPort> port_;
  std::string file_;
  std::string logged_;
};

/// Turns a device as the loop does, with a force of the test's, on a thread of its own.
class Turning {
 public:
  explicit Turning(client::HapticDevice& device, const Clock& clock)
      : thread_([this, &device, &clock] {
          LocalTime last = clock.now();
          while (!stop_) {
            device.waitForTick(last + std::chrono::milliseconds(1));
            last = clock.now();
            const client::DeviceState state = device.exchange(force_N_.load() * Vec3::UnitZ(), {});
            status_ = state.status;
            if (state.status == client::DeviceStatus::kOk) ++good_;
            if (state.status == client::DeviceStatus::kLost) ++lost_;
            device.sendForceEarly(force_N_.load() * Vec3::UnitZ());
          }
          if (!frozen_) (void)device.exchange(Vec3::Zero(), {});
        }) {}
  ~Turning() { stop(); }
  Turning(const Turning&) = delete;
  Turning& operator=(const Turning&) = delete;
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// The loop hangs: it commands nothing any more, not even zero.
  void freeze() {
    frozen_ = true;
    stop();
  }
  void push(double force_N) { force_N_ = force_N; }
  [[nodiscard]] int good() const { return good_; }
  [[nodiscard]] int lost() const { return lost_; }
  [[nodiscard]] bool runsAgain() {
    const int before = good_;
    return waitUntil(kPatience, [&] { return good_ > before + 20; });
  }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<bool> frozen_{false};
  std::atomic<double> force_N_{0.0};
  std::atomic<int> good_{0};
  std::atomic<int> lost_{0};
  std::atomic<client::DeviceStatus> status_{client::DeviceStatus::kNoData};
  std::thread thread_;
};

}  // namespace hapticast::testing
