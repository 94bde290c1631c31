// SPDX-License-Identifier: MIT
// Interpolates the scene at play time from the frames around it; dead reckoning beyond the newest
// frame.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/playout.hpp"
#include "client/haptics/playback/pose.hpp"
#include "client/haptics/playback/scene.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

/// Interpolation of poses between frames. kHermite is the default; the others are for comparison.
enum class Interpolation : std::uint8_t {
  kHold,     ///< newest frame at or before play time, at rest, with its acceleration
  kLinear,   ///< linear between the two positions
  kHermite,  ///< cubic Hermite of (p, v), with impacts as kinks
};

/// Holds the frames around play time, sorted by media time, and computes the scene.
///
/// Stale stream, measured in play time beyond the newest frame: dead reckoning with v for min(2
/// frames, 80 ms) (kExtrapolated). The acceleration ramps to 0 meanwhile, so that its force has no
/// step. The pose then rests until 300 ms (kHeld). Later the scene is kStale.
///
/// No interpolation crosses an epoch, or a gap of more than 1 s and three frame intervals. By the
/// same rules dead reckoning continues the last frame of the old epoch until play time reaches the
/// new epoch. So the arrival time of the new epoch has no effect. An object that the next frame
/// lacks is extrapolated until that frame. A new object of the next frame is absent until then.
///
/// Implausible velocities (|v| dt > 3 |displacement| + 4 mm) are shortened before the Hermite
/// interpolation. In a pause velocities, accelerations and blend rates are 0.
class SceneInterpolator {
 public:
  /// `pool` must outlive this object.
  SceneInterpolator(FramePool& pool, Interpolation interpolation) noexcept;

  /// Reads the frames that arrived (at most the pool's size) and returns the scene at `play_time`.
  /// Frames of an epoch before `stream.first_epoch` are released unused. The pointers in the scene
  /// are valid until the next call.
  const Scene& at(MediaTime play_time, const StreamTiming& stream,
                  const UserControls& user = {}) noexcept;

  /// Releases every frame that is held or has arrived. The first frame after the call jumps like a
  /// new epoch.
  void resync() noexcept;

  /// Returns the frames i-1, i, i+1, i+2 around play time within one epoch, null for a missing
  /// frame. For the thesis's temporal interpolation.
  [[nodiscard]] std::array<const PlayFrame*, 4> neighbours(MediaTime play_time) const noexcept;

  /// Number of frames that arrived after their play time.
  [[nodiscard]] std::uint64_t lateFrames() const noexcept { return late_frames_; }

 private:
  [[nodiscard]] const PlayFrame& frame(std::size_t i) const noexcept {
    return pool_.frame(held_[i]);
  }
  /// Index of the newest held frame at or before play time; kNone if there is none.
  [[nodiscard]] std::size_t beforeIndex(MediaTime play_time) const noexcept;
  /// Returns the frame after `before` if interpolation towards it is allowed, else null.
  [[nodiscard]] const PlayFrame* findNext(std::size_t before,
                                          const StreamTiming& stream) const noexcept;
  void popArrived(MediaTime play_time, std::uint32_t first_epoch) noexcept;
  void insert(FramePool::Index index, MediaTime play_time) noexcept;
  void release(std::size_t i) noexcept;
  /// Releases the frames that neither the cubic nor the future needs. Returns beforeIndex().
  std::size_t releaseUnneeded(MediaTime play_time) noexcept;
  void fillScene(std::size_t before, MediaTime play_time, const StreamTiming& stream,
                 const UserControls& user) noexcept;

  /// An instant between two frames, or after the newest.
  struct Moment {
    MediaTime begin;  // media time of the frame before
    double time_s = 0.0;
    double interval_s = 0.0;
    double limit_s = 0.0;  // end of the dead reckoning
    double blend = 0.0;
    double blend_rate_1_s = 0.0;
  };
  void placeObject(std::size_t i, const PlayObject& object, const Moment& moment) noexcept;
  [[nodiscard]] bool wasThere(const PlayObject& object) const noexcept;

  /// Cached values of a pair of frames; valid until a frame is inserted or released.
  struct FrameInterval {
    const PlayFrame* now = nullptr;  // null: the cache is empty
    const PlayFrame* next = nullptr;
    double interval_s = 0.0;
    double rate_1_s = 0.0;                               // 1 / interval_s
    std::array<const PlayObject*, kMaxObjects> after{};  // in `next`, for each object of `now`
    std::array<HermitePath, kMaxObjects> path;
    std::array<PlausibilityBounds, kMaxObjects> plausibility;
  };
  void cacheInterval(std::size_t before, const PlayFrame* next, double interval_s) noexcept;
  /// Computes the plausibility bounds from the frames around the pair that belong to the same
  /// epoch.
  void computeBounds(std::size_t before, const PlayFrame* next) noexcept;

  static constexpr std::size_t kNone = ~std::size_t{0};
  FramePool& pool_;
  Interpolation interpolation_;
  std::array<FramePool::Index, FramePool::kSlots> held_{};  // by epoch, then by media time
  std::size_t held_count_ = 0;
  FrameInterval pair_;
  Scene scene_;
  bool played_ = false;                              // a frame was played
  std::array<std::uint64_t, kMaxObjects> frames_{};  // id and layer of the last scene's objects
  std::size_t frame_count_ = 0;
  std::uint64_t late_frames_ = 0;
  // Time that the current frame was the only one. The blend towards a late next frame begins there.
  std::uint64_t alone_id_ = 0;
  double alone_s_ = 0.0;
};

}  // namespace hapticast::client
