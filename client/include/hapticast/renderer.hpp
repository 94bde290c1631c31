// SPDX-License-Identifier: MIT
// Haptic rendering: computes the force of a haptic video at the position of a hand, tick by tick.
// It is the code of hapticast-client: interpolation between frames, proxy, dynamic force, and the
// safety chain behind them.
//
// Contract
// - Time. The caller passes the time of each tick, in s. The time must rise. One tick is 1 ms: the
//   observers, the wall law and all limits are made for a loop of 1 kHz. The library reads no clock
//   here, so the same calls give the same bits.
// - Frames come from push(), from a Stream or from a MessagePlayer (stream.hpp), and only from one
//   of them for each Renderer. A frame of push() plays at the tick time frame.time_s + delay_s. The
//   renderer interpolates between two frames, so the next frame has to be there at that time. For
//   frames that are captured now, delay_s has to be a frame interval and the time of your pipeline.
//   Without a next frame the surface rests, and after 0.4 s its force fades out.
// - Begin outside. A hand that is inside an object at its first contact gets no force until it has
//   left the object.
// - Force. Tick::force_N is behind the safety chain: limited in size, rise, energy and heat. When
//   the chain had to limit a stream too often, the stream loses its trust: the force stays at zero
//   until Controls::rearm changes. "The force fades" means: it goes to zero within 0.2 s, and comes
//   back, faded in, when its cause has ended.
// - Device frame: x right, y up, z towards the user, origin at the centre of the workspace, mm.
// - Your part. No part of the library ever ran on a real device. If you send the force to a motor,
//   you are responsible for what the chain cannot see: the profile must fit the device (mass never
//   overstated, delay never understated), the loop must keep 1 kHz, and the motor must go to zero
//   by itself when your program or its link fails (20 ms without a command).
// - Threads. tick(), toDevice() and toNominal() have one thread; they never block or allocate.
//   begin() and push() have one thread, and setControls() has one. The three may be different.
// - Errors: frame.hpp. A Renderer that was moved from must not be used.
//
// Example: the force on a hand that goes down on a disc (`frame`: the example of frame.hpp).
//
//   hapticast::Renderer renderer;
//   renderer.begin({});
//   for (int i = 0; i < 1000; ++i) {
//     if (i % 40 == 0) {
//       frame.time_s = 1e-3 * (i + 40);
//       if (!renderer.push(frame)) std::puts("the renderer has too many frames");
//     }
//     const Eigen::Vector3d hand_mm(0.0, 0.0, 40.0 - 0.025 * i);
//     const hapticast::Tick& tick = renderer.tick(1e-3 * i, renderer.toDevice(hand_mm));
//     if (tick.contact) std::printf("%g N\n", tick.force_N.z());
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

/// Choices for the whole life of a Renderer.
struct RendererSettings {
  /// Surface model: how the contact is computed.
  enum class Surface : std::uint8_t {
    kPerturbed,  ///< Eq. 3 of the thesis
    kNormal,     ///< distance to the tangent plane
    kProxy       ///< god-object proxy with walls and friction
  };
  /// Device: `omni`, `falcon`, or the file of a profile. client/device/README.md has its keys.
  std::string profile = "omni";
  Surface surface = Surface::kProxy;
  bool thesis = false;  ///< true: the methods of the thesis (frame.hpp); `surface` is ignored then
  /// Stiffness of all surfaces, 0..1000. 0: that of the material, or else that of the profile.
  double stiffness_N_mm = 0.0;
  /// Limit of the stiffness of a material, 0..1000. 0: three times the stiffness of the profile.
  /// The safety chain also limits every stiffness to what the device can render stably.
  double stiffness_limit_N_mm = 0.0;
  /// Playout delay of frames from push(), 0..2 s. begin() refuses more than 28 frame intervals.
  double delay_s = 0.0;
};

/// Choices of the user, which may change at any time. The force follows without a step.
struct Controls {
  /// True: play time stops. The surface rests, and can still be touched. After the pause the newest
  /// frames play.
  bool paused = false;
  bool static_on = true;          ///< true: the force of the surface acts
  bool dynamic_on = true;         ///< true: the force of accelerations and impacts acts
  double stiffness_factor = 1.0;  ///< factor of every stiffness, 0.1..3
  double force_factor = 1.0;      ///< factor of both forces, 0..1
  /// Coefficient of both static and dynamic friction, 0..1. Absent: those of the material.
  std::optional<double> friction = {};
  /// Another value than before re-arms the force after a halt (Tick::halted).
  std::uint32_t rearm = 0;
};

/// Result of one tick. Positions are in the nominal frame, forces in the device frame.
struct Tick {
  std::uint64_t number = 0;                                  ///< number of the tick, from 1
  double time_s = 0.0;                                       ///< time that the caller passed
  double play_time_s = 0.0;                                  ///< media time of the rendered instant
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();         ///< force for the device
  Eigen::Vector3d static_force_N = Eigen::Vector3d::Zero();  ///< of the surface, before the limits
  Eigen::Vector3d dynamic_force_N = Eigen::Vector3d::Zero();  ///< of motion, within the limits
  Eigen::Vector3d hip_mm = Eigen::Vector3d::Zero();           ///< haptic interface point: the hand
  /// Point of the surface that the hand touches. It is valid while `contact` is true.
  Eigen::Vector3d contact_mm = Eigen::Vector3d::Zero();
  double penetration_mm = 0.0;       ///< distance between hand and surface; 0 without contact
  bool contact = false;              ///< true: the hand touches an object
  std::uint32_t safety_actions = 0;  ///< one bit for each name of listSafetyActions()
  bool halted = false;               ///< true: no force until Controls::rearm changes
  std::uint32_t object_id = 0;       ///< id of the object nearest to the hand; 0: none
  /// Position of the object `object_id` at play time.
  Eigen::Vector3d object_mm = Eigen::Vector3d::Zero();
  /// Height of that object's surface below the hand. 0 where the hand is beside the object.
  double height_mm = 0.0;
};

/// Returns the names of the bits of Tick::safety_actions, bit 0 first.
[[nodiscard]] const std::vector<std::string>& listSafetyActions();

/// A haptic renderer for one device.
class Renderer {
 public:
  /// Errors: std::invalid_argument (a setting outside its range), std::runtime_error (the profile
  /// cannot be read, or has a wrong line).
  explicit Renderer(const RendererSettings& settings = {});
  ~Renderer();
  Renderer(Renderer&& from) noexcept;
  Renderer& operator=(Renderer&& from) noexcept;

  /// Begins the stream that push() continues. A second call begins another stream, and frames of
  /// the stream before no longer play. Errors: std::invalid_argument (a value outside its range; or
  /// frames come from a Stream or a MessagePlayer). Thread: that of push().
  void begin(const StreamInfo& info);
  /// Adds a frame and returns true. A frame waits until a tick has played it. If 32 frames wait
  /// already, the function drops the new frame and returns false. Requires begin() before, and a
  /// time above that of the frame before. A frame whose time has passed plays at once. Errors:
  /// std::invalid_argument (no begin(), a value outside its range, sizes that do not match; the
  /// frame is not added).
  [[nodiscard]] bool push(const Frame& frame);
  /// Computes the force of the tick at `time_s`, in s. `position_mm` is the position of the hand in
  /// the device frame. `buttons` has one bit for each button of the device; the profile states
  /// their use. Returns a reference that is valid until the next tick. Before the first frame the
  /// force is zero. A time that does not rise, or a position that is not finite, counts as a tick
  /// without a measurement: the force fades. Throws nothing.
  const Tick& tick(double time_s, const Eigen::Vector3d& position_mm, std::uint32_t buttons = 0);
  /// Applies the user's choices from the next tick on. Limits values outside their range. Thread:
  /// one, which may differ from that of tick().
  void setControls(const Controls& controls);

  /// Converts a position from the nominal frame to the device frame: the nominal frame fits into
  /// the workspace of the device with one scale. begin() and the welcome of a Stream set the
  /// nominal frame. Before that it has the default size of StreamInfo.
  [[nodiscard]] Eigen::Vector3d toDevice(const Eigen::Vector3d& nominal_mm) const;
  /// Converts a position from the device frame to the nominal frame: the inverse of toDevice().
  [[nodiscard]] Eigen::Vector3d toNominal(const Eigen::Vector3d& device_mm) const;

  class Impl;

 private:
  friend class Stream;
  friend class MessagePlayer;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
