// SPDX-License-Identifier: MIT
// The second half of vision: reliefs and motion of tracked objects. A frame waits until the window
// of frames around it is complete, because its motion depends on later frames, too. The first half
// of the next frame does not depend on it, so both may run at the same time.
// Thread: one at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "server/vision/describe.hpp"
#include "server/vision/frame_motion.hpp"
#include "server/vision/vision_result.hpp"

namespace hapticast::server {

class FrameDescriber {
 public:
  /// `settings` and `clock` must outlive this object. `lookahead`, `clock`: as in FrameMotion.
  FrameDescriber(const SourceInfo& info, const VisionSettings& settings, int lookahead,
                 const Clock* clock)
      : settings_(settings),
        clock_(clock),
        lookahead_(lookahead),
        motion_(info, settings, lookahead, clock) {}

  /// Adds the reliefs of `objects` to the frame of `result`, and completes the oldest frame whose
  /// window is now complete. `clip_frame`: index of the frame in the clip.
  void add(const std::vector<TrackedObject>& objects, const DepthNoise& noise,
           const NominalFrame& nominal, VisionResult result, std::uint64_t clip_frame);
  /// Completes all frames that wait, with shorter windows.
  void completeAll(const NominalFrame& nominal);
  /// Begins a new epoch: forgets all poses and reliefs. Requires completeAll().
  void beginEpoch();
  /// Returns the motion, which add() uses.
  [[nodiscard]] FrameMotion& motion() { return motion_; }

  /// Returns the complete frames since the last call, in order.
  [[nodiscard]] std::vector<VisionResult> popCompleted() { return std::exchange(completed_, {}); }
  /// Returns the measurements of the stages since the last call, by object id, in order.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, StageReport>> popReports() {
    return std::exchange(reports_, {});
  }

 private:
  struct Pending {
    VisionResult result;
    std::uint64_t clip_frame = 0;
  };

  void addReliefs(const std::vector<TrackedObject>& objects, const DepthNoise& noise,
                  const NominalFrame& nominal, VisionResult& result);
  void complete(const NominalFrame& nominal);

  const VisionSettings& settings_;
  const Clock* clock_;
  int lookahead_;
  FrameMotion motion_;
  std::map<std::uint32_t, LayerCutter> cutters_;  // by object id
  std::vector<HapticObject> last_objects_;        // of the frame before
  std::deque<Pending> pending_;
  std::vector<VisionResult> completed_;
  std::vector<std::pair<std::uint32_t, StageReport>> reports_;
};

}  // namespace hapticast::server
