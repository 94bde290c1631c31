// SPDX-License-Identifier: MIT
#include "client/device/dhd/dhd_driver.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/device/dhd/dhd_sdk.hpp"
#include "client/device/helper/program/make_driver.hpp"
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
  DhdDevice(const hapticast_host& host, const char* id, hapticast_profile& profile)
      : sdk_(host), number_(sdk_.openDevice(id)), host_(host) {
    describe(profile);
    if (commandZero() && sdk_.enableForce(DhdSdk::kOn, number_) >= 0 && commandZero()) return;
    const std::string reason = sdk_.readError();
    end();
    throw std::runtime_error("the device refuses forces: " + reason +
                             "; switch it off and on, and run its maker's test program");
  }
  ~DhdDevice() { end(); }
  DhdDevice(const DhdDevice&) = delete;
  DhdDevice& operator=(const DhdDevice&) = delete;

  /// Opens each device for a moment: the SDK knows the serial number of an opened device only.
  static void list(const hapticast_host& host, const FoundDevice& found) {
    const DhdSdk sdk(host);
    const int count = sdk.getDeviceCount();
    if (count < 0) throw std::runtime_error(sdk.readError());
    for (int i = 0; i < count; ++i) {
      const int number = sdk.openId == nullptr ? sdk.open() : sdk.openId(static_cast<char>(i));
      if (number < 0) {
        found("", "it does not open: " + sdk.readError());
        continue;
      }
      found(sdk.readSerial(static_cast<char>(number)), "");
      (void)sdk.close(static_cast<char>(number));
    }
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

  /// Thread: any.
  bool commandZero() noexcept { return commandForce(Vec3::Zero()) >= 0; }

 private:
  void describe(hapticast_profile& profile) const {
    const std::string name = sdk_.readName(number_);
    for (const DhdFamily& family : kDhdFamilies) {
      if (name.find(family.name) == std::string::npos) continue;
      profile.peak_N = family.peak_N;
      profile.count_mm = family.count_mm;
      std::copy_n(family.workspace_mm.data(), 3, profile.workspace_mm);
    }
    copyText(sdk_.readSerial(number_), profile.serial, sizeof profile.serial);
  }

  /// Returns a negative value if the SDK reports an error. Thread: any.
  int commandForce(const Vec3& force_N) noexcept {
    return sdk_.setForce(force_N.z(), force_N.x(), force_N.y(), number_);
  }

  void logChange(bool answers) {
    if (std::exchange(answers_, answers) == answers) return;
    const std::string line =
        answers ? "dhd: the device answers again"
                : "dhd: the device reports an error: " + sdk_.readError() +
                      "; if it does not come back, switch it on and start the client again";
    host_.log(host_.self, line.c_str());
  }

  void end() {
    (void)commandZero();
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

}  // namespace

const hapticast_driver* dhdDriver() {
  static const hapticast_driver kDriver =
      makeDriver<DhdDevice>("dhd", "a device of Force Dimension, or a Falcon, by its SDK");
  return &kDriver;
}

}  // namespace hapticast::client
