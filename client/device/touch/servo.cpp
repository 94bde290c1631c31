// SPDX-License-Identifier: MIT
#include "client/device/touch/servo.hpp"

#include <chrono>

namespace hapticast::client {

namespace {
constexpr Duration kStaleCommand = std::chrono::milliseconds(20);  // as in hapticast_device.h
constexpr Duration kZeroPatience = std::chrono::milliseconds(50);
constexpr int kMostErrors = 16;  // of one frame: the library stacks them
}  // namespace

Servo::Servo(const HdFunctions& functions, unsigned device, const Clock& clock)
    : functions_(functions), device_(device), clock_(clock) {
  callback_ = functions_.scheduleAsynchronous(runFrame, this, HdFunctions::kHighestPriority);
  switchMotors(true);
  functions_.startScheduler();
}

Servo::~Servo() {
  (void)commandZero();
  switchMotors(false);
  functions_.stopScheduler();
  functions_.unschedule(callback_);
}

void Servo::command(const Vec3& force_N) noexcept {
  command_.store({force_N, clock_.now()});
  quiet_.store(false, std::memory_order_release);
}

void Servo::waitForFrame(LocalTime deadline) noexcept {
  frame_ended_.wait(seen_, deadline);
  seen_ = frame_ended_.rings();
}

bool Servo::commandZero() noexcept {
  quiet_.store(true, std::memory_order_release);
  const LocalTime deadline = clock_.now() + kZeroPatience;
  // The first frame that ends may have begun before.
  for (int frame = 0; frame < 2; ++frame) {
    const std::uint32_t rings = frame_ended_.rings();
    frame_ended_.wait(rings, deadline);
    if (frame_ended_.rings() != rings) continue;
    switchMotors(false);
    return false;
  }
  return !lost_;
}

void Servo::switchMotors(bool on) noexcept {
  functions_.makeCurrentDevice(device_);
  (on ? functions_.enable : functions_.disable)(HdFunctions::kForceOutput);
  motors_on_ = on;
}

unsigned Servo::runFrame(void* servo) noexcept {
  static_cast<Servo*>(servo)->frame();
  return HdFunctions::kContinue;
}

void Servo::frame() noexcept {
  functions_.makeCurrentDevice(device_);
  calibrate();
  next_.time = clock_.now();
  functions_.beginFrame(device_);
  int buttons = 0;
  functions_.getDoubles(HdFunctions::kPosition, next_.position_mm.data());
  functions_.getIntegers(HdFunctions::kButtons, &buttons);
  next_.buttons = static_cast<std::uint32_t>(buttons);
  const Command& newest = command_.load();
  const bool acts = !quiet_.load(std::memory_order_acquire) && next_.calibrated &&
                    clock_.now() - newest.time < kStaleCommand;
  const Vec3 force_N = acts ? newest.force_N : Vec3(Vec3::Zero());
  functions_.setDoubles(HdFunctions::kForce, force_N.data());
  functions_.endFrame(device_);
  collectErrors();
  reading_.store(next_);
  frame_ended_.ring();
}

/// A device that knows its position again is updated. One that needs its user's hand waits.
void Servo::calibrate() noexcept {
  const unsigned state = functions_.checkCalibration();
  next_.calibrated = state == HdFunctions::kCalibrated;
  if (state != HdFunctions::kNeedsUpdate) return;
  int supported = 0;
  functions_.getIntegers(HdFunctions::kCalibrationStyle, &supported);
  for (const int style : HdFunctions::kStyles) {
    if ((supported & style) == 0) continue;
    functions_.updateCalibration(static_cast<unsigned>(style));
    return;
  }
}

void Servo::collectErrors() noexcept {
  next_.lost = false;
  for (int i = 0; i < kMostErrors; ++i) {
    const unsigned code = functions_.getError().code;
    if (code == 0) break;
    next_.error = code;
    if (code == HdFunctions::kExceededForce) ++next_.limited;
    next_.lost = next_.lost || code == HdFunctions::kFault || code == HdFunctions::kCommunication ||
                 code == HdFunctions::kCommunicationSetUp;
  }
  lost_ = next_.lost;
  ++(next_.lost ? next_.faults : next_.frames);
}

}  // namespace hapticast::client
