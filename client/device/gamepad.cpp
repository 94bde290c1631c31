// SPDX-License-Identifier: MIT
// SDL is called in the main thread only. Two LatestValues connect the main thread and the loop.
#if HAPTICAST_SDL2
#include "client/device/gamepad.hpp"

#include <SDL.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "client/device/device_request.hpp"
#include "client/device/pointed_hand.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {

// Sticks do not return exactly to the middle. The value is XInput's dead zone of a left stick: 7849
// of 32767.
constexpr double kDeadZone = 0.24;
// Chosen: across the picture in two seconds, through the relief in one. Half a stick's deflection
// is a quarter of the speed, for fine movements.
constexpr double kAcross_mm_s = 80.0;
constexpr double kInto_mm_s = 30.0;
// Chosen: a press of 2 N on the hand's spring of 0.2 N/mm, and no longer way back.
constexpr double kMostAhead_mm = 10.0;
constexpr double kFull_N = 2.0;
// Chosen: ten cycles of the main thread. Older values count as zero, on both sides, and a rumble
// without a renewal ends.
constexpr Duration kInputValid = std::chrono::milliseconds(100);
constexpr std::uint32_t kRumble_ms = 100;

/// SDL's controller subsystem (RAII).
struct PadSystem {
  PadSystem() {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C is the client's
    // The pad moves the hand, whichever window has the keyboard.
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0)
      throw DeviceAbsent(std::string("--device gamepad: ") + SDL_GetError());
    // The pad is polled: events would wait for a window that may not exist.
    SDL_GameControllerEventState(SDL_IGNORE);
    SDL_JoystickEventState(SDL_IGNORE);
  }
  PadSystem(const PadSystem&) = delete;
  PadSystem& operator=(const PadSystem&) = delete;
  ~PadSystem() { SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER); }
};

struct ClosePad {
  void operator()(SDL_GameController* pad) const {
    SDL_GameControllerRumble(pad, 0, 0, 0);
    SDL_GameControllerClose(pad);
  }
};
using Pad = std::unique_ptr<SDL_GameController, ClosePad>;

/// Opens the first gamepad; null if there is none.
Pad openPad() {
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (SDL_IsGameController(i) != SDL_TRUE) continue;
    if (Pad pad{SDL_GameControllerOpen(i)}) return pad;
  }
  return nullptr;
}

std::string formatName(const Pad& pad) {
  const char* const name = SDL_GameControllerName(pad.get());
  return name == nullptr ? "gamepad" : name;
}

Vec2 readStick(const Pad& pad, SDL_GameControllerAxis x, SDL_GameControllerAxis y) {
  return Vec2(SDL_GameControllerGetAxis(pad.get(), x), SDL_GameControllerGetAxis(pad.get(), y)) /
         double{SDL_JOYSTICK_AXIS_MAX};
}

/// Deflection with the dead zone removed: 0 in the dead zone, 1 at the stick's end.
Vec2 share(const Vec2& stick) noexcept {
  const double deflection = stick.norm();
  if (!(deflection > kDeadZone)) return Vec2::Zero();
  const double beyond = std::min(1.0, (deflection - kDeadZone) / (1.0 - kDeadZone));
  return beyond * beyond / deflection * stick;
}

class Gamepad final : public HapticDevice {
 public:
  Gamepad(const PlantProfile& profile, const DeviceRequest& request)
      : hand_(profile, request.clock), clock_(request.clock), pad_(openPad()) {
    if (!pad_) throw DeviceAbsent("--device gamepad: none was found; is it plugged in?");
    driveMotors();
    for (const auto& button : {profile.pause_button, profile.rearm_button, profile.enable_button}) {
      if (button) used_buttons_ |= std::uint32_t{1} << *button;
    }
  }

  const DeviceProfile& profile() const noexcept override { return hand_.profile(); }
  std::string description() const override {
    return "gamepad (" + formatName(pad_) + "): its sticks lead a virtual device (" +
           profile().name + ")";
  }
  void waitForTick(LocalTime deadline) noexcept override { hand_.waitForTick(deadline); }

  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept override {
    const LocalTime now = clock_.now();
    rumbled_.store({.parts = meter_.next(report), .time = now});
    const Held& held = held_.load();
    const bool is_recent = now - held.time < kInputValid;
    lead(is_recent ? held.velocity_mm_s : Vec3(Vec3::Zero()), report.mapping);
    DeviceState state = hand_.exchange(force_N, report);
    state.buttons = held.buttons;
    if (!held.there) state.status = DeviceStatus::kLost;
    return state;
  }

  void poll() override {
    SDL_GameControllerUpdate();
    if (pad_ && SDL_GameControllerGetAttached(pad_.get()) != SDL_TRUE) {
      pad_.reset();
      message_.emplace_back("gamepad: unplugged; plug it in again");
    }
    if (!pad_) {
      pad_ = openPad();
      if (pad_) {
        message_.push_back("gamepad: " + formatName(pad_) +
                           " is connected again; A restores the force");
        driveMotors();
      }
    }
    held_.store(readHeld());
    rumble();
  }

  std::optional<std::string> nextMessage() override {
    if (message_.empty()) return std::nullopt;
    std::string line = std::move(message_.front());
    message_.pop_front();
    return line;
  }

 private:
  /// Input of the pad for the loop.
  struct Held {
    Vec3 velocity_mm_s = Vec3::Zero();  // nominal
    std::uint32_t buttons = 0;
    bool there = true;
    LocalTime time{};
  };
  /// Output of the loop for the motors.
  struct RumbleInput {
    ForceComponents parts;
    LocalTime time{};
  };

  void driveMotors() {
    if (SDL_GameControllerHasRumble(pad_.get()) != SDL_TRUE)
      message_.emplace_back("gamepad: this device cannot rumble and renders no force");
  }

  [[nodiscard]] Held readHeld() const {
    Held held{.there = pad_ != nullptr, .time = clock_.now()};
    if (!pad_) return held;
    held.velocity_mm_s =
        stickVelocity_mm_s(readStick(pad_, SDL_CONTROLLER_AXIS_LEFTX, SDL_CONTROLLER_AXIS_LEFTY),
                           readStick(pad_, SDL_CONTROLLER_AXIS_RIGHTX, SDL_CONTROLLER_AXIS_RIGHTY));
    for (int i = 0; i < SDL_CONTROLLER_BUTTON_MAX; ++i) {
      const auto button = static_cast<SDL_GameControllerButton>(i);
      if (SDL_GameControllerGetButton(pad_.get(), button) != 0) held.buttons |= 1U << i;
    }
    held.buttons &= used_buttons_;
    return held;
  }

  void rumble() {
    if (!pad_) return;
    const RumbleInput& rumble_input = rumbled_.load();
    const bool is_recent = clock_.now() - rumble_input.time < kInputValid;
    const ForceComponents parts = is_recent ? rumble_input.parts : ForceComponents{};
    SDL_GameControllerRumble(pad_.get(), motorLevel(parts.sustained_N),
                             motorLevel(parts.transient_N), kRumble_ms);
  }

  /// Moves the hand's target with the sticks, within the workspace and close to the HIP. So an
  /// obstacle causes no wind-up.
  void lead(const Vec3& velocity_mm_s, const DeviceMapping& mapping) noexcept {
    if (!led_ && velocity_mm_s == Vec3::Zero()) return;
    if (!std::exchange(led_, true)) goal_mm_ = hand_.tip_mm();
    goal_mm_ += kTick_s * mapping.scale * velocity_mm_s;
    Vec3 ahead_mm = goal_mm_ - hand_.tip_mm();
    if (ahead_mm.norm() > kMostAhead_mm) ahead_mm *= kMostAhead_mm / ahead_mm.norm();
    const Vec3 reach_mm = 0.5 * profile().workspace_mm;
    goal_mm_ = (hand_.tip_mm() + ahead_mm).cwiseMax(-reach_mm).cwiseMin(reach_mm);
    hand_.moveTowards(goal_mm_);
  }

  // Loop:
  PointedHand hand_;
  const Clock& clock_;
  TransientDetector meter_;
  bool led_ = false;
  Vec3 goal_mm_ = Vec3::Zero();  // device frame
  // Shared:
  LatestValue<Held> held_;            // the main thread writes it
  LatestValue<RumbleInput> rumbled_;  // the loop writes it
  // Main:
  std::uint32_t used_buttons_ = 0;
  std::deque<std::string> message_;
  PadSystem system_;
  Pad pad_;
};

}  // namespace

Vec3 stickVelocity_mm_s(const Vec2& left, const Vec2& right) noexcept {
  const Vec2 across = kAcross_mm_s * share(left);
  return {across.x(), -across.y(), kInto_mm_s * share({0.0, right.y()}).y()};
}

// The perceived vibration grows with the square of the motor's speed, and below about a tenth the
// motor does not turn. Hence the root.
std::uint16_t motorLevel(double force_N) noexcept {
  const double level = std::sqrt(std::clamp(force_N / kFull_N, 0.0, 1.0));
  return static_cast<std::uint16_t>(std::lround(65535.0 * level));
}

std::unique_ptr<HapticDevice> openGamepad(const DeviceRequest& request) {
  PlantProfile profile = loadProfile(request.profile);
  profile.pause_button = SDL_CONTROLLER_BUTTON_START;
  profile.rearm_button = SDL_CONTROLLER_BUTTON_A;
  return std::make_unique<Gamepad>(profile, request);
}

std::vector<std::string> listGamepads(const DeviceRequest& /*request*/) {
  const PadSystem system;
  std::vector<std::string> lines;
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    const char* const name = SDL_JoystickNameForIndex(i);
    std::string& line = lines.emplace_back(name == nullptr ? "a gamepad without a name" : name);
    if (SDL_IsGameController(i) != SDL_TRUE)
      line.append(", but SDL has no map of its buttons (set SDL_GAMECONTROLLERCONFIG)");
  }
  return lines;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_SDL2
