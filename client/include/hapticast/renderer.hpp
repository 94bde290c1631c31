// SPDX-License-Identifier: MIT
// Haptic rendering: computes the force of a haptic video at the position of a hand, tick by tick.
// It is the code of hapticast-client: interpolation between frames, proxy, dynamic force, and the
// safety chain behind them.
//
// Contract
// - Time. The caller passes the time of each tick, in s. It must rise. One tick is 1 ms: the
//   observers, the wall law and all limits are made for a loop of 1 kHz. The library reads no clock
//   here, so the same calls give the same bits.
// - Frames. Give frames by push(), by a Stream (stream.hpp) or by a MessagePlayer (stream.hpp), but
//   only by one of them for each Renderer. push() plays a frame at the tick time frame.time_s +
//   delay_s. The interpolation needs the next frame as well, so push each frame before its time.
// - Force. Tick::force_N is behind the safety chain: limited in size, rise, energy and heat. It is
//   in the device frame: x right, y up, z towards the user, origin at the workspace's centre.
// - Your part. If you send the force to a motor, you are responsible for what the chain cannot see:
//   the profile must fit the device (mass never overstated, delay never understated), the loop must
//   keep 1 kHz, and the motor must go to zero when your program or its link fails.
// - Threads. tick() has one thread and never blocks or allocates. push() has another one.
//
// Example: the force on a hand that goes down on a frame.
//
//   hapticast::Renderer renderer;
//   renderer.begin({});
//   frame.time_s = 0.0;
//   renderer.push(frame);
//   for (int i = 0; i < 1000; ++i) {
//     const Eigen::Vector3d hand_mm(0.0, 0.0, 40.0 - 0.025 * i);
//     const hapticast::Tick& tick = renderer.tick(1e-3 * i, renderer.toDevice(hand_mm));
//     std::printf("%g N\n", tick.force_N.z());
//   }
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hapticast/frame.hpp"

namespace hapticast {

struct RendererSettings {
  /// How the contact is computed. kProxy is the default of hapticast.
  enum class Surface : std::uint8_t {
    kPerturbed,  ///< Eq. 3 of the thesis
    kNormal,     ///< distance to the tangent plane
    kProxy       ///< god-object proxy with walls and friction
  };
  /// Device: `omni`, `falcon`, or the file of a profile (lines `key = value`).
  std::string profile = "omni";
  Surface surface = Surface::kProxy;
  bool thesis = false;          ///< true: the methods of the thesis, as published
  double stiffness_N_mm = 0.0;  ///< of all surfaces; 0: that of the author or the profile
  /// Limit of the stiffness that an author may request; 0: three times the profile's stiffness.
  double stiffness_limit_N_mm = 0.0;
  /// Playout delay of frames from push(), s, 0..2.
  double delay_s = 0.0;
};

/// Choices of the user, which may change at any time. The force follows without a step.
struct Controls {
  bool paused = false;                  ///< true: play time stops
  bool static_on = true;                ///< force of the surface
  bool dynamic_on = true;               ///< force of the acceleration
  double stiffness_factor = 1.0;        ///< 0.1..3
  double force_factor = 1.0;            ///< 0..1
  std::optional<double> friction = {};  ///< 0..1; absent: the author's
  /// Another value re-arms the force after a loss of trust or of the device.
  std::uint32_t rearm = 0;
};

/// What one tick computed.
struct Tick {
  std::uint64_t number = 0;                                   ///< from 1
  double time_s = 0.0;                                        ///< of the caller
  double play_time_s = 0.0;                                   ///< media time of the scene
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();          ///< for the device
  Eigen::Vector3d static_force_N = Eigen::Vector3d::Zero();   ///< of the surface, before the limits
  Eigen::Vector3d dynamic_force_N = Eigen::Vector3d::Zero();  ///< of accelerations and impacts
  Eigen::Vector3d hip_mm = Eigen::Vector3d::Zero();      ///< haptic interface point, nominal frame
  Eigen::Vector3d contact_mm = Eigen::Vector3d::Zero();  ///< surface point; valid with contact
  double penetration_mm = 0.0;                           ///< nominal frame; 0 without contact
  bool contact = false;
  std::uint32_t safety_actions = 0;  ///< one bit for each name of listSafetyActions()
  bool halted = false;               ///< true: no force until Controls::rearm changes
  std::uint32_t object_id = 0;       ///< nearest object; 0: none
  Eigen::Vector3d object_mm = Eigen::Vector3d::Zero();  ///< its position at play time
  double height_mm = 0.0;  ///< height of its surface below the hand; 0: the hand is beside it
};

/// Returns the names of the bits of Tick::safety_actions, bit 0 first.
[[nodiscard]] const std::vector<std::string>& listSafetyActions();

class Renderer {
 public:
  /// Errors: std::invalid_argument, std::runtime_error (an unreadable profile).
  explicit Renderer(const RendererSettings& settings = {});
  ~Renderer();
  Renderer(Renderer&& from) noexcept;
  Renderer& operator=(Renderer&& from) noexcept;

  /// Begins the stream that push() continues. Frames before it are dropped. Errors:
  /// std::invalid_argument. Thread: that of push().
  void begin(const StreamInfo& info);
  /// Adds a frame. Requires begin(), and times that rise. At most 32 frames wait: returns false,
  /// and drops the frame, if no tick has played the earlier ones. Errors: std::invalid_argument (a
  /// value outside its range, or sizes that do not match; the frame is not added).
  bool push(const Frame& frame);
  /// Computes the force of the tick at `time_s`. `position_mm` is the hand's position in the device
  /// frame. `buttons` has a bit for each button. A time that does not rise, or a position that is
  /// not finite, counts as a tick without a measurement: the force fades.
  const Tick& tick(double time_s, const Eigen::Vector3d& position_mm, std::uint32_t buttons = 0);
  /// Applies the user's choices from the next tick on. Values outside their range are limited.
  /// Thread: one.
  void setControls(const Controls& controls);

  /// Convert positions between nominal and device frame, by the mapping of the last tick.
  [[nodiscard]] Eigen::Vector3d toDevice(const Eigen::Vector3d& nominal_mm) const;
  [[nodiscard]] Eigen::Vector3d toNominal(const Eigen::Vector3d& device_mm) const;

  class Impl;

 private:
  friend class Stream;
  friend class MessagePlayer;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
