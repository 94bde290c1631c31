// SPDX-License-Identifier: MIT
// A pointer as a device: a hand's spring and mass between the pointer and the tip, so that what the
// force does is seen, as the way that the tip stays behind.
#include <algorithm>
#include <stdexcept>

#include "client/device/open_device.hpp"
#include "client/device/virtual_device.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

namespace {

// Chosen: a hand follows what it sees within a tenth of a second, ...
constexpr double kFollow_1_s = 40.0;
// ... and is never more than this behind its goal as it sees it: 400 mm/s at most.
constexpr double kMostBehind_mm = 20.0;
// Where a pointer may be: beyond any workspace that a server may announce nobody points.
constexpr double kMost_mm = 1000.0;

class Mouse final : public HapticDevice {
 public:
  Mouse(const PlantProfile& profile, const DeviceRequest& request)
      : hand_(profile, Hand::light(), request.clock),
        pointer_(*request.pointer),
        seen_(request.seen) {}

  const DeviceProfile& profile() const noexcept override { return hand_.profile(); }
  std::string description() const override {
    return "mouse: a virtual device (" + profile().name + ") on a spring behind the pointer";
  }
  void waitForTick(LocalTime deadline) noexcept override { hand_.waitForTick(deadline); }
  DeviceState exchange(const Vec3& force_N) noexcept override {
    follow();
    return hand_.exchange(force_N);
  }

 private:
  /// The pointer comes in steps, fifty a second; the hand's goal moves smoothly.
  void follow() noexcept {
    const PointerTarget& pointer = pointer_.load();
    const DeviceMapping& mapping = seen_.load().mapping;
    if (!pointer.known || !pointer.position_mm.allFinite()) return;
    if (!follows_) goal_mm_ = mapping.toNominal(hand_.truePosition_mm());
    follows_ = true;
    const Vec3 wanted_mm = pointer.position_mm.cwiseMax(-kMost_mm).cwiseMin(kMost_mm);
    Vec3 way_mm = wanted_mm - goal_mm_;
    if (way_mm.norm() > kMostBehind_mm) way_mm *= kMostBehind_mm / way_mm.norm();
    // Critically damped: it arrives without going beyond.
    velocity_mm_s_ +=
        kTick_s * (kFollow_1_s * kFollow_1_s * way_mm - 2.0 * kFollow_1_s * velocity_mm_s_);
    goal_mm_ += kTick_s * velocity_mm_s_;
    hand_.setTarget(mapping.toDevice(goal_mm_));
  }

  VirtualDevice hand_;
  LatestValue<PointerTarget>& pointer_;
  LatestValue<TickReport>& seen_;
  bool follows_ = false;
  Vec3 goal_mm_ = Vec3::Zero();  // nominal
  Vec3 velocity_mm_s_ = Vec3::Zero();
};

}  // namespace

std::unique_ptr<HapticDevice> openMouse(const DeviceRequest& request) {
  if (request.pointer == nullptr)
    throw std::runtime_error("--device mouse: needs the window to point in (--view on)");
  return std::make_unique<Mouse>(loadProfile(request.profile), request);
}

}  // namespace hapticast::client
