// SPDX-License-Identifier: MIT
// Stores the poses and cell motions of all objects in a window of frames. Motion is computed for
// the frame in the middle of the window. Thread: the one that runs Vision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/object_pose.hpp"

namespace hapticast::server {

/// Poses of an object in a window of frames around one frame, here called the middle frame.
struct MotionWindow {
  std::vector<Sample> samples;
  /// Index of the middle frame in `samples`; nullopt: the object was lost in this frame.
  std::optional<std::size_t> at;
  /// Kind of reference point in the middle frame.
  ReferencePoint point = ReferencePoint::kVisibleCentroid;
};

/// Poses and cell motions of all objects, by object id.
class MotionHistory {
 public:
  /// Pose and cell motion of one object in one frame.
  struct Entry {
    std::uint64_t frame = 0;
    double time_s = 0.0;
    ObjectPose pose;
    CellFlow cells;
  };

  /// Adds the entry of object `id`; frames in order. Do not call it for a frame in which the object
  /// is lost.
  void add(std::uint32_t id, Entry entry) { entries_[id].push_back(std::move(entry)); }
  /// Deletes the entries of frames before `frame`. The last entry of a lost object remains for
  /// `keep_lost` more frames, because the object is assumed to rest at its last pose.
  void dropBefore(std::uint64_t frame, std::uint64_t keep_lost);

  /// Returns the poses of object `id` in the frames at most `lookahead` frames from `frame`, in
  /// nominal mm.
  [[nodiscard]] MotionWindow window(std::uint32_t id, std::uint64_t frame, int lookahead,
                                    const NominalFrame& nominal) const;
  /// Returns the motion of object `id` at the middle frame of `around`. If the object was lost in
  /// that frame, the motion is zero and the position is its last pose.
  [[nodiscard]] Motion motion(std::uint32_t id, const MotionWindow& around, int lookahead,
                              const NominalFrame& nominal) const;
  /// Returns whether the cell motion of object `id` was measured in all frames of the window around
  /// `frame`.
  [[nodiscard]] bool hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const;
  /// Returns the motion grid of object `id` at `frame`. Returns null if no cell motion was
  /// measured.
  [[nodiscard]] std::shared_ptr<const MotionGrid> grid(std::uint32_t id, std::uint64_t frame,
                                                       int lookahead,
                                                       const NominalFrame& nominal) const;

 private:
  /// Returns the entries at most `lookahead` frames away from `frame`, in order.
  [[nodiscard]] std::vector<const Entry*> findAround(std::uint32_t id, std::uint64_t frame,
                                                     int lookahead) const;

  std::map<std::uint32_t, std::deque<Entry>> entries_;
};

}  // namespace hapticast::server
