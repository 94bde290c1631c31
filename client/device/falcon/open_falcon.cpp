// SPDX-License-Identifier: MIT
// The Novint Falcon as a device kind. A request is sent each millisecond. The tick begins with its
// reply, about a quarter of a millisecond later. The next request carries the force of that tick.
#if HAPTICAST_LIBUSB
#include <fmt/core.h>

#include <atomic>

#include "client/device/falcon/falcon_link.hpp"
#include "client/device/falcon/pilot.hpp"
#include "client/device/open_device.hpp"
#include "client/device/sleep_until.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

namespace {

// Chosen: the tick begins without a reply half a period after the request.
constexpr Duration kPatience{500'000};

const char* toText(FalconPilot::Phase phase) {
  switch (phase) {
    case FalconPilot::Phase::kHoming:
      return "Falcon: pull the grip out as far as it goes, then push it in as far as it goes; its "
             "lights are red until it knows where it is";
    case FalconPilot::Phase::kOutside:
      return "Falcon: it knows where it is (blue); bring the grip to the middle";
    case FalconPilot::Phase::kReady:
      return "Falcon: ready (green)";
    case FalconPilot::Phase::kAway:
      break;
  }
  return "";
}

class Falcon final : public HapticDevice {
 public:
  Falcon(const DeviceProfile& profile, const DeviceRequest& request)
      : profile_(profile),
        clock_(request.clock),
        gain_(request.falcon.gain),
        pilot_(request.falcon.gain),
        link_(request.falcon, request.clock, request.log) {}

  const DeviceProfile& profile() const noexcept override { return profile_; }
  std::string description() const override {
    return fmt::format("Falcon ({}, {:g} counts a N m)", profile_.name, gain_);
  }

  void waitForTick(LocalTime deadline) noexcept override {
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

  DeviceState exchange(const Vec3& force_N, const TickReport& /*report*/) noexcept override {
    force_N_ = force_N;
    FalconNews event;
    while (link_.popEvent(event)) {
      if (std::exchange(life_, event.life) != event.life) pilot_.lost();
      pilot_.onReply(event.reply, event.at);
    }
    if (!link_.there()) pilot_.lost();
    phase_.store(pilot_.phase(), std::memory_order_relaxed);
    return pilot_.state();
  }

  void sendForceEarly(const Vec3& force_N) noexcept override { force_N_ = force_N; }

  std::optional<std::string> nextMessage() override {
    if (auto line = link_.nextMessage()) return line;
    const FalconPilot::Phase phase = phase_.load(std::memory_order_relaxed);
    if (std::exchange(logged_, phase) == phase || *toText(phase) == '\0') return std::nullopt;
    return toText(phase);
  }

  std::optional<DeviceTraffic> traffic() const noexcept override { return link_.traffic(); }

 private:
  DeviceProfile profile_;
  const Clock& clock_;
  double gain_;
  FalconPilot pilot_;  // loop
  LocalTime due_{};    // loop: time of the last request
  Vec3 force_N_ = Vec3::Zero();
  std::uint32_t life_ = 0;
  std::atomic<FalconPilot::Phase> phase_{FalconPilot::Phase::kAway};
  FalconPilot::Phase logged_ = FalconPilot::Phase::kAway;  // main
  FalconLink link_;                                        // last member: its thread ends first
};

}  // namespace

std::unique_ptr<HapticDevice> openFalcon(const DeviceRequest& request) {
  PlantProfile profile = loadProfile(request.profile, "falcon");
  profile.pause_button = FalconButton::kCentre;
  profile.rearm_button = FalconButton::kRight;
  try {
    return std::make_unique<Falcon>(profile, request);
  } catch (const FalconError& error) {
    throw DeviceAbsent(std::string("--device falcon: ") + error.what());
  }
}

std::vector<std::string> listFalcons() {
  std::vector<std::string> lines;
  for (const FalconFound& found : findFalcons()) {
    lines.push_back(found.problem.empty() ? "serial number " + found.serial
                                          : "found, but " + found.problem);
  }
  return lines;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_LIBUSB
