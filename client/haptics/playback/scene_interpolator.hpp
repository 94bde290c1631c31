// SPDX-License-Identifier: MIT
// The surface at play time from the frames around it. Real-time room: noexcept, no heap, no locks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/pose.hpp"
#include "client/haptics/playback/scene.hpp"
#include "client/haptics/stream_timing.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

/// How poses between frames are found. kHermite is the default; the others are there to be
/// compared.
enum class Interpolation : std::uint8_t {
  kHold,     ///< newest frame at or before play time, standing still, with its acceleration
  kLinear,   ///< linear between the two positions
  kHermite,  ///< cubic Hermite of (p, v), with the kink of an impact between the frames where it
             ///< happened
};

/// Holds the frames of the last moments, sorted by media time, and finds the scene at play time.
/// Stale, measured in play time beyond the newest frame: carried on with v for min(2 frames, 80 ms)
/// (kExtrapolated; the acceleration ramps to 0 meanwhile, so that its force does not step),
/// standing still until 300 ms (kHeld), then kFaded. Nothing is interpolated across an epoch: the
/// last frame of the old one is carried on by the same rules until the new one's first is due, so
/// it does not matter when that arrives; nor across a gap of more than 1 s (and three frame
/// intervals). An object that is missing in the next frame is carried on
/// likewise until that frame; one that is new in it is not yet there. Velocities that cannot be
/// meant (|v| dt > 3 |displacement| + 4 mm) are shortened before they bend the Hermite. While
/// paused the scene stands still: velocities, accelerations and blend rate are 0.
class SceneInterpolator {
 public:
  SceneInterpolator(FramePool& pool, Interpolation interpolation) noexcept;

  /// Takes what has arrived (bounded by the pool) and returns the scene. Frames of an epoch before
  /// `stream.first_epoch` are given back unused. The pointers in it hold until the next call.
  const Scene& at(MediaTime play_time, const StreamTiming& stream,
                  const UserControls& user = {}) noexcept;

  /// Gives back every frame that is held or has arrived: the first one that comes from now on jumps
  /// like that of a new epoch.
  void resync() noexcept;

  /// For the thesis's temporal interpolation: the frames i-1, i, i+1, i+2 around play time within
  /// one epoch (null where there is none).
  [[nodiscard]] std::array<const PlayFrame*, 4> neighbours(MediaTime play_time) const noexcept;

  /// Frames that arrived after they were due, counted.
  [[nodiscard]] std::uint64_t lateFrames() const noexcept { return late_frames_; }

 private:
  [[nodiscard]] const PlayFrame& frame(std::size_t i) const noexcept {
    return pool_.frame(held_[i]);
  }
  /// Index of the newest held frame at or before play time, or kNone.
  [[nodiscard]] std::size_t beforeIndex(MediaTime play_time) const noexcept;
  /// The frame after `before` that it can be interpolated with, or null.
  [[nodiscard]] const PlayFrame* findNext(std::size_t before,
                                          const StreamTiming& stream) const noexcept;
  void popArrived(MediaTime play_time, std::uint32_t first_epoch) noexcept;
  void insert(FramePool::Index index, MediaTime play_time) noexcept;
  void release(std::size_t i) noexcept;
  /// Keeps what the cubic needs and what is ahead; returns beforeIndex().
  std::size_t releaseUnneeded(MediaTime play_time) noexcept;
  void fillScene(std::size_t before, MediaTime play_time, const StreamTiming& stream,
                 const UserControls& user) noexcept;

  /// An instant between two frames, or after the newest.
  struct Moment {
    MediaTime begin;  // of the frame before
    double time_s = 0.0;
    double interval_s = 0.0;
    double limit_s = 0.0;  // carried on with its velocity for so long
    double blend = 0.0;
    double blend_rate_1_s = 0.0;
  };
  void placeObject(std::size_t i, const PlayObject& object, const Moment& moment) noexcept;
  [[nodiscard]] bool wasThere(const PlayObject& object) const noexcept;

  /// What two frames say of the time between them; holds until another frame is held or released.
  struct FrameInterval {
    const PlayFrame* now = nullptr;  // null: not known
    const PlayFrame* next = nullptr;
    double interval_s = 0.0;
    double rate_1_s = 0.0;                               // 1 / interval
    std::array<const PlayObject*, kMaxObjects> after{};  // in `next`, for each object of `now`
    std::array<HermitePath, kMaxObjects> path;
    std::array<PlausibilityBounds, kMaxObjects> plausibility;
  };
  void cacheInterval(std::size_t before, const PlayFrame* next, double interval_s) noexcept;
  /// In the frames around the pair, as far as they belong together.
  void computeBounds(std::size_t before, const PlayFrame* next) noexcept;

  static constexpr std::size_t kNone = ~std::size_t{0};
  FramePool& pool_;
  Interpolation interpolation_;
  std::array<FramePool::Index, FramePool::kSlots> held_{};  // by epoch, then media time
  std::size_t held_count_ = 0;
  FrameInterval pair_;
  Scene scene_;
  bool played_ = false;                              // a frame has been played
  std::array<std::uint64_t, kMaxObjects> frames_{};  // id and layer of the last scene's objects
  std::size_t frame_count_ = 0;
  std::uint64_t late_frames_ = 0;
  // How long the frame played was the only one known: a late next one is blended in from there.
  std::uint64_t alone_id_ = 0;
  double alone_s_ = 0.0;
};

}  // namespace hapticast::client
