// SPDX-License-Identifier: MIT
// From tracked objects to the descriptor: nominal units, the window around a frame, what changed.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "server/vision/motion_window.hpp"
#include "server/vision/tracker.hpp"

namespace hapticast::server {

/// Nominal coordinates of poses.
struct NominalFrame {
  Workspace workspace;
  DepthRange range;

  [[nodiscard]] Sample sample(const Pose& pose, double time_s) const;
  /// Nominal mm per px right, px down and mm of working depth.
  [[nodiscard]] Vec3 mmPerStep() const;
};

/// The poses of all objects over the frames around the one that is described.
class MotionHistory {
 public:
  struct Entry {
    std::uint64_t frame = 0;
    double time_s = 0.0;
    Pose pose;
    CellFlow cells;
  };

  /// Frames come in order; lost objects have no entry.
  void add(std::uint64_t frame, double time_s, const std::vector<TrackedObject>& objects);
  void dropBefore(std::uint64_t frame);

  /// Motion of object `id` at `frame`. Without an entry there (lost) it rests at its last known
  /// pose.
  [[nodiscard]] Motion motion(std::uint32_t id, std::uint64_t frame, int lookahead,
                              const NominalFrame& nominal) const;
  [[nodiscard]] std::shared_ptr<const MotionGrid> grid(std::uint32_t id, std::uint64_t frame,
                                                       int lookahead,
                                                       const NominalFrame& nominal) const;
  /// The largest acceleration of any object over whole windows.
  [[nodiscard]] double largestAcceleration_mm_s2(int lookahead, const NominalFrame& nominal) const;

 private:
  std::map<std::uint32_t, std::deque<Entry>> entries_;
};

/// The object as it enters the descriptor; its motion comes later, with the window. `last`: the
/// same object in the frame before, or null; an unchanged relief keeps its pointer and its
/// changed_in_frame.
HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings);

}  // namespace hapticast::server
