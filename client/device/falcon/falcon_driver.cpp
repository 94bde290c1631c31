// SPDX-License-Identifier: MIT
#if HAPTICAST_LIBUSB
#include "client/device/falcon/falcon_driver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/device/falcon/falcon_link.hpp"
#include "client/device/falcon/kinematics.hpp"
#include "client/device/falcon/pilot.hpp"
#include "client/device/helper/program/make_driver.hpp"
#include "client/device/profile/device_profile.hpp"
#include "client/device/sleep_until.hpp"

namespace hapticast::client {

namespace {

// Chosen: the tick begins without a reply half a period after the request.
constexpr Duration kPatience{500'000};

const char* toText(FalconPilot::Phase phase) {
  switch (phase) {
    case FalconPilot::Phase::kHoming:
      return "Falcon: pull the grip out as far as possible, then push it in as far as possible; "
             "the lights are red until the device is homed";
    case FalconPilot::Phase::kOutside:
      return "Falcon: the device is homed (blue); move the grip to the middle";
    case FalconPilot::Phase::kReady:
      return "Falcon: ready (green)";
    case FalconPilot::Phase::kAway:
      break;
  }
  return "";
}

FalconSettings readFalconSettings(const hapticast_host& host, const char* serial) {
  const auto option = [&host](const char* key) { return host.option(host.self, key); };
  FalconSettings settings;
  if (serial != nullptr) settings.serial = serial;
  if (const char* const file = option("firmware")) settings.firmware_file = file;
  if (const char* const text = option("gain")) {
    const auto gain = parseFalconGain(text);
    if (!gain)
      throw std::runtime_error(
          fmt::format("--device-option gain={}: is not a number from {:g} to {:g}", text,
                      kLeastFalconGain, kMostFalconGain));
    settings.gain = *gain;
  }
  if (const char* const event = option("event_character"))
    settings.event_character = std::string(event) != "0";
  return settings;
}

/// An opened Falcon. The loop's thread calls wait() and exchange().
class Falcon {
 public:
  Falcon(const hapticast_host& host, const char* id, hapticast_profile& profile)
      : host_(host),
        settings_(readFalconSettings(host, id)),
        pilot_(settings_.gain),
        link_(settings_, clock_,
              [host](const std::string& line) { host.log(host.self, line.c_str()); }) {
    copyProfile(loadDeviceProfile("falcon"), profile);
    profile.peak_N = std::min(profile.peak_N, computeFalconPeak_N(settings_.gain));
    copyText(link_.serial(), profile.serial, sizeof profile.serial);
    profile.pause_button = FalconButton::kCentre;
    profile.rearm_button = FalconButton::kRight;
  }

  static void list(const hapticast_host& /*host*/, const FoundDevice& found) {
    for (const FalconFound& each : findFalcons()) found(each.serial, each.problem);
  }

  void wait(LocalTime deadline) {
    if (!link_.there()) {
      sleepUntil(deadline);
      return;
    }
    const LocalTime now = clock_.now();
    due_ += kTickPeriod;
    // Skip the deadlines that a stall has missed; the grid remains.
    if (due_ + kPatience < now) due_ += (now - due_) / kTickPeriod * kTickPeriod;
    if (due_ > now + kTickPeriod) due_ = now;
    sleepUntil(due_);
    link_.send(pilot_.request(force_N_, clock_.now()));
    (void)link_.waitForReply(due_ + kPatience);
  }

  void exchange(const Vec3& force_N, hapticast_state& state) {
    force_N_ = force_N;
    FalconNews event;
    while (link_.popEvent(event)) {
      if (std::exchange(life_, event.life) != event.life) pilot_.onLost();
      pilot_.onReply(event.reply, event.at);
    }
    if (!link_.there()) pilot_.onLost();
    logPhase();
    const DeviceState reading = pilot_.state();
    state.status = static_cast<std::int32_t>(reading.status);
    std::copy_n(reading.position_mm.data(), 3, state.position_mm);
    state.buttons = reading.buttons;
    state.taken_ns = reading.time.time_since_epoch().count();
    const DeviceTraffic traffic = link_.traffic();
    state.replies = traffic.round_trips;
    state.misses = traffic.misses;
    state.damaged = traffic.resyncs;
    state.saturated = pilot_.saturated();
  }

  void warn(bool on) { pilot_.warn(on); }

  /// Thread: any.
  bool commandZero() { return link_.sendZero(); }

 private:
  void logPhase() {
    const FalconPilot::Phase phase = pilot_.phase();
    if (std::exchange(logged_, phase) != phase && *toText(phase) != '\0')
      host_.log(host_.self, toText(phase));
  }

  const SteadyClock clock_;
  const hapticast_host host_;
  const FalconSettings settings_;
  FalconPilot pilot_;
  LocalTime due_{};  // time of the last request
  Vec3 force_N_ = Vec3::Zero();
  std::uint32_t life_ = 0;
  FalconPilot::Phase logged_ = FalconPilot::Phase::kAway;
  FalconLink link_;  // last member: its thread ends first
};

}  // namespace

double computeFalconPeak_N(double gain) {
  const Vec3 workspace_m = 1e-3 * loadDeviceProfile("falcon").workspace_mm;
  double most_count_per_N = 0.0;  // of the worst motor, for the worst direction and corner
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 position_m = kFalconCentre_m;
    for (int axis = 0; axis < 3; ++axis)
      position_m[axis] += ((corner >> axis & 1) != 0 ? 0.5 : -0.5) * workspace_m[axis];
    Eigen::Matrix3d counts;  // for 1 N along each axis
    for (int axis = 0; axis < 3; ++axis) {
      const auto torques = falconTorques(position_m, Vec3::Unit(axis));
      if (!torques) return 0.0;
      counts.col(axis) = gain * *torques;
    }
    most_count_per_N = std::max(most_count_per_N, counts.rowwise().norm().maxCoeff());
  }
  return FalconPilot::kMostMotor / most_count_per_N;
}

const hapticast_driver* falconDriver() {
  static const hapticast_driver kDriver = makeDriver<Falcon>("falcon", "a Novint Falcon on USB");
  return &kDriver;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_LIBUSB
