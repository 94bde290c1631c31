// SPDX-License-Identifier: MIT
#include "client/device/helper/program/helper_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "client/device/sleep_until.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
using std::chrono::microseconds;
using std::chrono::milliseconds;
// Chosen: a client that runs answers within 0.1 ms. Later forces go out with the next tick.
constexpr Duration kForcePatience = microseconds(400);
constexpr Duration kSlowExchange = microseconds(500);
constexpr Duration kHungCall = milliseconds(20);  // as in hapticast_device.h
constexpr int kMostEndTicks = 100;

std::int64_t toNs(LocalTime time) { return time.time_since_epoch().count(); }
}  // namespace

HelperLoop::HelperLoop(const hapticast_driver& driver, hapticast_device* device, SharedPage& page,
                       const Clock& clock)
    : driver_(driver), device_(device), page_(page), clock_(clock) {}

void HelperLoop::run() noexcept {
  LocalTime deadline = clock_.now() + kTickPeriod;
  for (int end_ticks = 0; end_ticks < kMostEndTicks; ++end_ticks) {
    tick(deadline);
    const LocalTime now = clock_.now();
    deadline = std::max(deadline + kTickPeriod, now);
    if (!ending_.load(std::memory_order_relaxed)) end_ticks = 0;
    if (end_ticks > 0 && gate_.atZero()) break;
  }
  ended_.store(true, std::memory_order_release);
}

void HelperLoop::tick(LocalTime deadline) noexcept {
  wait(deadline);
  const std::uint32_t rings = page_.commanded.rings();
  const std::uint64_t published = reading_.number;
  exchange();
  if (reading_.number == published) return;
  page_.read.ring();
  page_.commanded.wait(rings, clock_.now() + kForcePatience);
  if (page_.commanded.rings() != rings) exchange();
}

void HelperLoop::wait(LocalTime deadline) noexcept {
  if (driver_.wait == nullptr) {
    sleepUntil(deadline);
    return;
  }
  beginCall();
  (void)driver_.wait(device_, toNs(deadline));
  (void)endCall();
}

/// Commands the newest force. Publishes the reading if the driver has one.
void HelperLoop::exchange() noexcept {
  (void)page_.command.load(command_);
  const LocalTime now = clock_.now();
  const Vec3 force_N =
      gate_.computeForce_N(command_, !ending_.load(std::memory_order_relaxed), now);
  if (gate_.reduces()) ++reading_.reduced;
  if (command_.reading > handed_over_ && command_.reading <= reading_.number) {
    handed_over_ = command_.reading;
    // A reading without data has no position, and the time of an old one is overwritten.
    const std::int64_t taken_ns = taken_ns_[handed_over_ % taken_ns_.size()];
    if (taken_ns > 0 && reading_.number - handed_over_ < taken_ns_.size())
      reading_.delay_ns = toNs(now) - taken_ns;
  }
  // Set before the call, so that monitor() sees a force that hangs in the driver.
  if (!gate_.atZero()) force_acts_.store(true, std::memory_order_release);
  hapticast_state state{};
  state.size = sizeof state;
  state.status = HAPTICAST_NO_DATA;
  beginCall();
  warn();
  const int result = driver_.exchange(device_, force_N.data(), &state);
  if (endCall() > kSlowExchange) ++reading_.slow;
  if (gate_.atZero()) force_acts_.store(false, std::memory_order_release);
  if (result != HAPTICAST_OK) state.status = HAPTICAST_LOST;
  publish(state);
}

/// Switches the sign of the device, if it has one and the client wants a change.
void HelperLoop::warn() noexcept {
  const bool has_sign = driver_.size >= offsetof(hapticast_driver, warn) + sizeof driver_.warn &&
                        driver_.warn != nullptr;
  const bool warns = command_.warns != 0;
  if (has_sign && std::exchange(warns_, warns) != warns) driver_.warn(device_, warns ? 1 : 0);
}

/// Passes a reading on. A second exchange() of a tick without a new position adds nothing.
void HelperLoop::publish(const hapticast_state& state) noexcept {
  if (state.status == HAPTICAST_NO_DATA && reading_.number != 0 &&
      reading_.state.status == HAPTICAST_OK && state.replies == reading_.state.replies &&
      state.misses == reading_.state.misses)
    return;
  ++reading_.number;
  reading_.state = state;
  taken_ns_[reading_.number % taken_ns_.size()] = state.taken_ns;
  page_.reading.store(reading_);
}

void HelperLoop::beginCall() noexcept {
  call_began_ns_.store(toNs(clock_.now()), std::memory_order_release);
}

Duration HelperLoop::endCall() noexcept {
  const Duration lasted{toNs(clock_.now()) - call_began_ns_.exchange(0)};
  // The other thread has commanded zero meanwhile.
  if (lasted > kHungCall) gate_.close();
  return lasted;
}

Duration HelperLoop::monitor() noexcept {
  const std::int64_t began_ns = call_began_ns_.load(std::memory_order_acquire);
  if (began_ns == 0) return {};
  const Duration lasted{toNs(clock_.now()) - began_ns};
  if (lasted > kHungCall && force_acts_.load(std::memory_order_acquire))
    (void)driver_.zero(device_);
  return lasted;
}

}  // namespace hapticast::client
