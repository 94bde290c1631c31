// SPDX-License-Identifier: MIT
// Averages the heights of an object over the frames before and after each frame (bake). The
// object's motion carries the heights that the other frames measured to the frame. Each pixel uses
// the widest of the windows of +-1, 2, 4, 8 and 16 frames whose mean agrees with the means of all
// narrower ones within the noise (the rule of intersecting confidence intervals: Goldenshluger and
// Nemirovski 1997). The noise is measured on fourth differences in time. So a surface that deforms,
// or whose motion is wrong, keeps the heights that the live server has. Where the live server holds
// the surface constant, the mean is over all frames at rest within +-32. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// What places of the picture mean.
struct FusionView {
  Workspace workspace;
  DepthRange range;  ///< mapped range
  CameraModel camera;
};

/// Fuses the frames of one clip, in order.
class ReliefFusion {
 public:
  /// Frames on each side of a frame that can have a part in its heights. Chosen: two means of as
  /// many frames as the static-region filter's; half in pictures of more than 1 Mpx.
  static constexpr std::size_t kReach = 32;
  static constexpr std::size_t kShortReach = 16;

  explicit ReliefFusion(const FusionView& view);

  /// Adds the next frame. Requires VisionSettings::offline.
  void push(VisionResult result);
  /// Returns the next frame whose window is complete, with fused reliefs; nullopt: none is.
  /// `ended`: no frame follows, so that windows end with the clip. `wanted`: false leaves the
  /// reliefs as they are, which is fast.
  [[nodiscard]] std::optional<VisionResult> next(bool ended, bool wanted = true);
  /// Makes the next frame independent of the result of the frame before.
  void beginBlock() { sent_.clear(); }

 private:
  struct Sent {
    std::shared_ptr<const Relief> relief;
    std::uint64_t changed_in_frame;
  };
  void fuse(HapticFrame& frame);
  [[nodiscard]] std::shared_ptr<const Relief> fuseObject(const HapticObject& object,
                                                         std::size_t index) const;

  FusionView view_;
  std::size_t reach_;                // frames on each side
  std::deque<VisionResult> frames_;  // from at_ - reach_ on
  std::size_t at_ = 0;               // place of the next frame in frames_
  std::map<ObjectKey, Sent> sent_;   // the reliefs of the last fused frame
};

}  // namespace hapticast::server
