// SPDX-License-Identifier: MIT
#include "client/device/touch/touch_driver.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/device/helper/program/make_driver.hpp"
#include "client/device/profile/device_profile.hpp"
#include "client/device/touch/servo.hpp"

namespace hapticast::client {

namespace {

// Chosen: a library that is silent for so long does not come back by itself.
constexpr Duration kSilence = std::chrono::milliseconds(100);
constexpr Duration kFirstFrame = std::chrono::seconds(2);

/// An opened device. It ends before `disableDevice`.
class HdHandle {
 public:
  HdHandle(const HdFunctions& functions, const char* name)
      : functions_(functions), device_(functions.openDevice(name)) {}
  ~HdHandle() { functions_.disableDevice(device_); }
  HdHandle(const HdHandle&) = delete;
  HdHandle& operator=(const HdHandle&) = delete;
  [[nodiscard]] unsigned get() const { return device_; }

 private:
  const HdFunctions& functions_;
  const unsigned device_;
};

class Touch {
 public:
  Touch(const hapticast_host& host, const char* id, hapticast_profile& profile)
      : functions_(host),
        host_(host),
        handle_(functions_, host.option(host.self, "name")),
        serial_(requireSerial(id)),
        servo_(functions_, handle_.get(), clock_) {
    servo_.waitForFrame(clock_.now() + kFirstFrame);
    if (servo_.read().frames + servo_.read().faults == 0)
      throw std::runtime_error("its library does not call back: is its scheduler licensed?");
    last_new_ = clock_.now();
    copyProfile(loadDeviceProfile("omni"), profile);
    copyText(serial_, profile.serial, sizeof profile.serial);
  }

  /// The library knows a device only after it has opened it.
  static void list(const hapticast_host& host, const FoundDevice& found) {
    const HdFunctions functions(host);
    const HdHandle handle(functions, host.option(host.self, "name"));
    found(functions.readSerial(), "");
  }

  void exchange(const Vec3& force_N, hapticast_state& state) {
    servo_.command(force_N);
    const ServoReading& reading = servo_.read();
    const LocalTime now = clock_.now();
    const std::uint64_t number = reading.frames + reading.faults;
    const bool fresh = std::exchange(number_, number) != number;
    if (fresh) last_new_ = now;
    const bool silent = now - last_new_ > kSilence;
    if (silent == servo_.motorsOn()) servo_.switchMotors(!silent);
    logChanges(reading, silent);
    state.status = HAPTICAST_OK;
    if (!fresh || !reading.calibrated) state.status = HAPTICAST_NO_DATA;
    if (reading.lost || silent) state.status = HAPTICAST_LOST;
    std::copy_n(reading.position_mm.data(), 3, state.position_mm);
    state.buttons = reading.buttons;
    state.taken_ns = reading.time.time_since_epoch().count();
    state.replies = reading.frames;
    state.misses = reading.faults;
    state.saturated = reading.limited;
  }

  void wait(LocalTime deadline) { servo_.waitForFrame(deadline); }
  bool commandZero() { return servo_.commandZero(); }

 private:
  [[nodiscard]] std::string requireSerial(const char* wanted) const {
    std::string serial = functions_.readSerial();
    if (wanted == nullptr || *wanted == '\0' || serial == wanted) return serial;
    throw std::runtime_error("the device has the serial number " + serial + ", not " + wanted +
                             "; --device-option name=NAME selects another device by its name in "
                             "the maker's set-up program");
  }

  void logLine(const std::string& line) const { host_.log(host_.self, ("touch: " + line).c_str()); }

  /// Logs one line for each change.
  void logChanges(const ServoReading& reading, bool silent) {
    if (std::exchange(silent_, silent) != silent)
      logLine(silent ? "its library does not call back; the motors are off"
                     : "its library calls back again");
    if (std::exchange(calibrated_, reading.calibrated) != reading.calibrated)
      logLine(reading.calibrated ? "calibrated"
                                 : "its position is unknown: put the stylus into its inkwell");
    if (std::exchange(error_, reading.error) == reading.error) return;
    if (reading.error == HdFunctions::kWarmMotors) {
      logLine("its motors are warm: rest for a minute");
      return;
    }
    const char* const text = functions_.getErrorString(reading.error);
    logLine("its library reports: " + std::string(text == nullptr ? "an error" : text));
  }

  const SteadyClock clock_;
  const HdFunctions functions_;
  const hapticast_host host_;
  const HdHandle handle_;
  const std::string serial_;
  std::uint64_t number_ = 0;
  LocalTime last_new_{};
  unsigned error_ = 0;
  bool silent_ = false;
  bool calibrated_ = true;
  Servo servo_;  // last member: its frames end first
};

}  // namespace

const hapticast_driver* touchDriver() {
  static const hapticast_driver kDriver =
      makeDriver<Touch>("touch", "a Touch (Phantom Omni) by OpenHaptics", HAPTICAST_NEEDS_NETWORK);
  return &kDriver;
}

}  // namespace hapticast::client
