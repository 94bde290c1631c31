// SPDX-License-Identifier: MIT
#include "client/device/dhd/dhd_driver.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/device/dhd/dhd_sdk.hpp"
#include "client/device/helper/program/driver_texts.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {

/// Values of the makers' public data sheets; 0: not stated. Nothing was measured. A workspace is
/// the largest box in the stated cylinder.
struct DhdFamily {
  const char* name;  // part of the SDK's name in lower case
  double peak_N;
  double count_mm;
  std::array<double, 3> workspace_mm;
};
constexpr std::array kDhdFamilies = {
    DhdFamily{"omega", 12.0, 0.01, {110.0, 110.0, 110.0}},
    DhdFamily{"delta", 20.0, 0.02, {280.0, 280.0, 260.0}},
    DhdFamily{"sigma", 20.0, 0.0, {130.0, 130.0, 130.0}},
    DhdFamily{"falcon", 8.0, 0.0, {60.0, 60.0, 60.0}},
};

constexpr double kMm_m = 1e3;

/// An opened device. The SDK's x axis points towards the user, y to the right, z up.
class DhdDevice {
 public:
  DhdDevice(const DhdSdk& sdk, char number, const hapticast_host& host)
      : sdk_(sdk), number_(number), host_(host) {
    if (commandForce(Vec3::Zero()) >= 0 && sdk_.enableForce(DhdSdk::kOn, number_) >= 0 &&
        commandForce(Vec3::Zero()) >= 0)
      return;
    const std::string reason = sdk_.readError();
    end();
    throw std::runtime_error("the device refuses forces: " + reason +
                             "; switch it off and on, and run its maker's test program");
  }
  ~DhdDevice() { end(); }
  DhdDevice(const DhdDevice&) = delete;
  DhdDevice& operator=(const DhdDevice&) = delete;

  void describe(hapticast_profile& profile) const {
    const std::string name = sdk_.readName(number_);
    for (const DhdFamily& family : kDhdFamilies) {
      if (name.find(family.name) == std::string::npos) continue;
      profile.peak_N = family.peak_N;
      profile.count_mm = family.count_mm;
      std::copy_n(family.workspace_mm.data(), 3, profile.workspace_mm);
    }
    (void)sdk_.readSerial(number_).copy(profile.serial, sizeof profile.serial - 1);
  }

  /// Commands the force and reads the position. Both are one call of the SDK each.
  void exchange(const Vec3& force_N, hapticast_state& state) {
    const int sent = commandForce(force_N);
    if (sent == DhdSdk::kSaturated) ++counters_.saturated;
    // Before the call: the delay from a position to its force must not be understated.
    counters_.taken_ns = clock_.now().time_since_epoch().count();
    Vec3 sdk_m = Vec3::Zero();
    const int received = sdk_.getPosition(&sdk_m.x(), &sdk_m.y(), &sdk_m.z(), number_);
    const bool answers = sent >= 0 && received >= 0;
    const bool fresh = answers && received != DhdSdk::kTimeGuard;
    if (fresh) ++counters_.replies;
    if (!answers) ++counters_.misses;
    logChange(answers);
    counters_.size = state.size;
    state = counters_;
    state.size = sizeof state;
    state.status = !answers ? HAPTICAST_LOST : fresh ? HAPTICAST_OK : HAPTICAST_NO_DATA;
    const Vec3 position_mm = kMm_m * Vec3(sdk_m.y(), sdk_m.z(), sdk_m.x());
    std::copy_n(position_mm.data(), 3, state.position_mm);
    if (fresh) state.buttons = sdk_.readButtons(number_);
  }

  /// Returns a negative value if the SDK reports an error. Thread: any.
  int commandForce(const Vec3& force_N) noexcept {
    return sdk_.setForce(force_N.z(), force_N.x(), force_N.y(), number_);
  }

 private:
  void logChange(bool answers) {
    if (std::exchange(answers_, answers) == answers) return;
    const std::string line =
        answers ? "dhd: the device answers again"
                : "dhd: the device reports an error: " + sdk_.readError() +
                      "; if it does not come back, switch it on and start the client again";
    host_.log(host_.self, line.c_str());
  }

  void end() {
    (void)commandForce(Vec3::Zero());
    (void)sdk_.enableForce(DhdSdk::kOff, number_);
    (void)sdk_.close(number_);
  }

  const SteadyClock clock_;
  const DhdSdk sdk_;
  const char number_;
  const hapticast_host host_;
  hapticast_state counters_{};  // its counters and the last time
  bool answers_ = true;
};

DhdDevice& toDhd(hapticast_device* device) { return *reinterpret_cast<DhdDevice*>(device); }

/// Opens each device for a moment: the SDK knows the serial number of an opened device only.
int listDhd(const hapticast_host* host,
            void (*found)(void* to, const char* id, const char* problem), void* to, char why[256]) {
  try {
    const DhdSdk sdk(*host);
    const int count = sdk.getDeviceCount();
    if (count < 0) throw std::runtime_error(sdk.readError());
    for (int i = 0; i < count; ++i) {
      const int number = sdk.openId == nullptr ? sdk.open() : sdk.openId(static_cast<char>(i));
      if (number < 0) {
        found(to, "", ("it does not open: " + sdk.readError()).c_str());
        continue;
      }
      found(to, sdk.readSerial(static_cast<char>(number)).c_str(), nullptr);
      (void)sdk.close(static_cast<char>(number));
    }
    return HAPTICAST_OK;
  } catch (const std::runtime_error& error) {
    writeReason(error.what(), why);
    return HAPTICAST_LOST;
  }
}

hapticast_device* openDhd(const hapticast_host* host, const char* id, hapticast_profile* profile,
                          char why[256]) {
  try {
    const DhdSdk sdk(*host);
    auto device = std::make_unique<DhdDevice>(sdk, sdk.openDevice(id), *host);
    device->describe(*profile);
    return reinterpret_cast<hapticast_device*>(device.release());
  } catch (const std::runtime_error& error) {
    writeReason(error.what(), why);
    return nullptr;
  }
}

int exchangeDhd(hapticast_device* device, const double force_N[3], hapticast_state* state) {
  toDhd(device).exchange({force_N[0], force_N[1], force_N[2]}, *state);
  return HAPTICAST_OK;
}

int zeroDhd(hapticast_device* device) {
  return toDhd(device).commandForce(Vec3::Zero()) >= 0 ? 0 : 1;
}

void closeDhd(hapticast_device* device) { delete &toDhd(device); }

}  // namespace

const hapticast_driver* dhdDriver() {
  static const hapticast_driver kDriver{sizeof(hapticast_driver),
                                        HAPTICAST_DEVICE_ABI,
                                        "dhd",
                                        "a device of Force Dimension, or a Falcon, by its SDK",
                                        "MIT",
                                        0,
                                        0,
                                        listDhd,
                                        openDhd,
                                        nullptr,
                                        exchangeDhd,
                                        zeroDhd,
                                        closeDhd};
  return &kDriver;
}

}  // namespace hapticast::client
