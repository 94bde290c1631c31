// SPDX-License-Identifier: MIT
// Computes the scene at play time: it interpolates between the two frames around play time. Beyond
// the newest frame it uses dead reckoning.
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

/// Interpolation of poses between frames. kHermite is the default. The others are for comparisons.
enum class Interpolation : std::uint8_t {
  /// No interpolation: the newest frame at or before play time, at rest, with its acceleration.
  kHold,
  kLinear,   ///< linear between the positions of both frames
  kHermite,  ///< cubic Hermite curve of position and velocity; impacts are kinks
};

/// Stores the frames around play time, sorted by media time, and computes the scene from them.
///
/// After the newest frame the scene has three stages, measured in play time. First dead reckoning
/// moves the objects, for min(2 frames, 80 ms) (kExtrapolated). Meanwhile the acceleration falls to
/// 0, so that its force has no step. Then the objects rest until 300 ms after the frame (kHeld).
/// Later the scene is kStale.
///
/// No interpolation crosses an epoch. None crosses a gap that is longer than both 1 s and three
/// frame intervals. Until play time reaches a new epoch, dead reckoning continues the last frame of
/// the old epoch by the same rules. So the arrival time of the new epoch has no effect. An object
/// that is missing in the next frame is extrapolated until that frame. An object that begins with
/// the next frame is absent until then.
///
/// A velocity v is implausible if |v| times the frame interval exceeds 4 mm plus 3 times the
/// displacement between the frames. The Hermite interpolation shortens v to that limit. In a pause
/// all velocities, accelerations and blend rates are 0.
class SceneInterpolator {
 public:
  /// `pool` must outlive this object.
  SceneInterpolator(FramePool& pool, Interpolation interpolation) noexcept;

  /// Accepts all frames that have arrived, and returns the scene at `play_time`. Frames of an epoch
  /// before `stream.first_epoch` return to the pool unused. The pointers in the scene are valid
  /// until the next call.
  const Scene& at(MediaTime play_time, const StreamTiming& stream,
                  const UserControls& user = {}) noexcept;

  /// Returns all stored and all arrived frames to the pool. In the next scene with a frame,
  /// `jumped` is true, as at a new epoch.
  void resync() noexcept;

  /// Returns the four frames i-1, i, i+1 and i+2 around play time, for the thesis's interpolation.
  /// Frame i is the newest one at or before play time. An entry is null if the frame is missing or
  /// has another epoch.
  [[nodiscard]] std::array<const PlayFrame*, 4> neighbours(MediaTime play_time) const noexcept;

  /// Returns the number of frames that the loop has taken from the pool.
  [[nodiscard]] std::uint64_t framesTaken() const noexcept { return pool_.taken(); }
  /// Returns the number of frames that arrived after their play time.
  [[nodiscard]] std::uint64_t lateFrames() const noexcept { return late_frames_; }

 private:
  [[nodiscard]] const PlayFrame& frame(std::size_t i) const noexcept {
    return pool_.frame(held_[i]);
  }
  /// Returns the index of the newest stored frame at or before play time, or kNone if there is
  /// none.
  [[nodiscard]] std::size_t beforeIndex(MediaTime play_time) const noexcept;
  /// Returns the frame after the frame `before`. Returns null if interpolation towards it is not
  /// allowed.
  [[nodiscard]] const PlayFrame* findNext(std::size_t before,
                                          const StreamTiming& stream) const noexcept;
  void popArrived(MediaTime play_time, std::uint32_t first_epoch) noexcept;
  void insert(FramePool::Index index, MediaTime play_time) noexcept;
  void release(std::size_t i) noexcept;
  /// Gives all frames back to the pool that neither the interpolation nor a later play time needs.
  /// Returns beforeIndex(play_time).
  std::size_t releaseUnneeded(MediaTime play_time) noexcept;
  void fillScene(std::size_t before, MediaTime play_time, const StreamTiming& stream,
                 const UserControls& user) noexcept;

  /// An instant between two frames, or after the newest one.
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

  /// Cached values of a pair of frames. They are valid until a frame is inserted or returned to the
  /// pool.
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
  /// Computes the plausibility bounds from the frame `before`, the frame `next`, and their
  /// neighbours of the same epoch.
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
  // Play time for which the current frame had no next frame. The blend towards a late next frame
  // begins there.
  std::uint64_t alone_id_ = 0;
  double alone_s_ = 0.0;
};

}  // namespace hapticast::client
