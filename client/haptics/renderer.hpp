// SPDX-License-Identifier: MIT
// Haptic rendering: computes the force from the device's position, once in every tick. The steps
// are motion estimation, scene interpolation, contact, dynamic force and safety chain
// (client/haptics/README.md, "One tick").
//
// A tick uses no heap, locks, system calls or exceptions. Time is an argument. All state has a
// fixed size.
// Thread: loop, unless a function states another one.
#pragma once

#include <atomic>
#include <cstddef>

#include "client/haptics/contact/proxy_surface.hpp"
#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/contact/thesis_interpolation.hpp"
#include "client/haptics/dynamic_force.hpp"
#include "client/haptics/estimation/hip_estimator.hpp"
#include "client/haptics/flight_recorder.hpp"
#include "client/haptics/parameter_rate_limiter.hpp"
#include "client/haptics/playback/playout.hpp"
#include "client/haptics/playback/scene_interpolator.hpp"
#include "client/haptics/safety/chain.hpp"
#include "client/haptics/user_force_mix.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

struct RendererSettings {
  DeviceProfile profile;
  SurfaceKind surface = SurfaceKind::kProxy;
  Interpolation interpolation = Interpolation::kHermite;
  /// Algorithms of the renderer. kHapticast interpolates the scene between frames and computes the
  /// contact in every tick. kThesis computes the displacement of the HIP at each frame and
  /// interpolates between these displacements (contact/thesis_interpolation.hpp).
  Method method = Method::kHapticast;
  /// True: the client detected the device automatically, so there is no force until the user
  /// re-arms it.
  bool unconfirmed = false;
  double stiffness_N_mm = 0.0;  ///< if above 0, it replaces the stiffness of author and profile
  /// Limit of the stiffness that an author requests. 0 selects three times the profile's stiffness.
  double stiffness_limit_N_mm = 0.0;
};

/// The haptic renderer. The object needs about 1 MB because of the flight recorder, so do not place
/// it on the stack.
class HapticRenderer {
 public:
  using Log = SpscRing<TickReport, 4096>;
  /// Reads frames from `pool`, and the latest values of `stream` and `user`. It appends every
  /// report to `log`, which may be null. If the log is full, the renderer drops the report and
  /// counts it. All arguments must outlive the renderer.
  HapticRenderer(const RendererSettings& settings, FramePool& pool,
                 LatestValue<StreamTiming>& stream, LatestValue<UserControls>& user,
                 Log* log) noexcept;

  /// Runs one tick at the time `now` with the reading `state`. Returns the report of the tick; its
  /// force_N is the force for the device. Thread: loop.
  const TickReport& tick(LocalTime now, const DeviceState& state) noexcept;
  /// Sets the duration of the last tick. The next report includes it. Thread: loop.
  void setLastTickDuration(Duration last) noexcept { report_.tick_duration = last; }
  /// Ramps the force to zero at the end of a run. Thread: loop.
  void stop() noexcept {
    safety_.stop();
    report_.inputs.stopping = true;
  }

  [[nodiscard]] const TickReport& report() const noexcept { return report_; }
  /// Returns the number of reports that were dropped because the log was full. Thread: loop, or any
  /// after the end of the loop.
  [[nodiscard]] std::uint64_t droppedReports() const noexcept { return dropped_reports_; }
  /// Returns the number of frames that arrived after their play time. Thread: as droppedReports().
  [[nodiscard]] std::uint64_t lateFrames() const noexcept { return lookup_.lateFrames(); }
  [[nodiscard]] FlightRecorder& recorder() noexcept { return recorder_; }

 private:
  /// What does not continue that of the last tick.
  struct Changes {
    bool by_stream = false;  // the connection or the workspace
    bool by_user = false;    // the method, the surface model, or the end of a pause
    [[nodiscard]] bool any() const noexcept { return by_stream || by_user; }
  };
  Changes updateInputs(const StreamTiming& stream, const UserControls& user) noexcept;
  Contact computeContact(const Scene& scene, const Vec3& hip_mm) noexcept;
  SafetyInput safetyInput(const HipEstimate& hip, const Contact& contact,
                          const Scene& scene) const noexcept;
  double stiffness_N_mm(const InterpolatedObject* object) const noexcept;
  double stiffnessLimit_N_mm() const noexcept;
  bool isSoftened(const InterpolatedObject* object) const noexcept;
  void updateMaterial(SafetyInput& input) noexcept;
  double deepest_mm(const Scene& scene) const noexcept;
  void reportTick(LocalTime now, MediaTime play_time, const Scene& scene,
                  const SafetyOutput& out) noexcept;
  void reportObject(const Contact& contact, const Scene& scene) noexcept;
  Fault classifyFault(const SafetyOutput& out, const HipEstimate& hip, bool device_lost) noexcept;
  void recordTick() noexcept;

  const RendererSettings& settings_;
  LatestValue<StreamTiming>& stream_;
  LatestValue<UserControls>& user_;
  Log* log_;
  HipEstimator motion_;
  Playout playout_;
  SceneInterpolator lookup_;
  ThesisInterpolation thesis_;
  ProxySurface proxies_;
  DynamicForce dynamic_;
  UserForceMix force_mix_;
  ParameterRateLimiter stiffness_;
  ParameterRateLimiter damping_;
  SafetyChain safety_;
  Workspace workspace_;
  DeviceMapping mapping_;
  bool connected_ = false;
  bool paused_ = false;
  bool faulty_ = false;  // a lasting fault is reported once
  std::uint32_t stopped_ = 0;
  std::uint32_t rearmed_ = 0;
  std::uint32_t rearmed_by_itself_ = 0;
  bool acknowledged_ = false;  // the user re-armed the force in this tick
  SafetyStates states_;
  MediaTime scene_time_{};  // media time of the last tick's scene
  std::uint64_t dropped_reports_ = 0;
  TickReport report_;
  FlightRecorder recorder_;
};

}  // namespace hapticast::client
