// SPDX-License-Identifier: MIT
// Pointer as a device: spring and mass of a hand between the pointer and the HIP. The force becomes
// visible as the distance between both.
#include <stdexcept>

#include "client/device/device_request.hpp"
#include "client/device/open_device.hpp"
#include "client/device/pointed_hand.hpp"
#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

namespace {

// Limit of the pointer's position: beyond any workspace that a server may announce.
constexpr double kMost_mm = 1000.0;

class Mouse final : public HapticDevice {
 public:
  Mouse(const PlantProfile& profile, const DeviceRequest& request)
      : hand_(profile, request.clock), pointer_(*request.pointer) {}

  const DeviceProfile& profile() const noexcept override { return hand_.profile(); }
  std::string description() const override {
    return "mouse: a virtual device (" + profile().name + ") on a spring behind the pointer";
  }
  void waitForTick(LocalTime deadline) noexcept override { hand_.waitForTick(deadline); }
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept override {
    const PointerTarget& pointer = pointer_.load();
    if (pointer.known && pointer.position_mm.allFinite())
      hand_.moveTowards(
          report.mapping.toDevice(pointer.position_mm.cwiseMax(-kMost_mm).cwiseMin(kMost_mm)));
    return hand_.exchange(force_N, report);
  }

 private:
  PointedHand hand_;
  LatestValue<PointerTarget>& pointer_;
};

}  // namespace

bool followsPointer(const HapticDevice& device) {
  return dynamic_cast<const Mouse*>(&device) != nullptr;
}

std::unique_ptr<HapticDevice> openMouse(const DeviceRequest& request) {
  if (request.pointer == nullptr)
    throw std::runtime_error("--device mouse: needs the window to point in (--view on)");
  return std::make_unique<Mouse>(loadProfile(request.profile), request);
}

}  // namespace hapticast::client
