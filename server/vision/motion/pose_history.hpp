// SPDX-License-Identifier: MIT
// History of all objects' poses and cells over the frames around the described frame. Thread: the
// one that runs Vision.
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

/// Poses of an object over the frames around one frame, in order of time.
struct MotionWindow {
  std::vector<Sample> samples;
  std::optional<std::size_t> at;  ///< index of that frame; nullopt: the object was lost there
  ReferencePoint point = ReferencePoint::kVisibleCentroid;  ///< in that frame
};

/// Poses and cells of all objects, by object id.
class MotionHistory {
 public:
  /// One object in one frame.
  struct Entry {
    std::uint64_t frame = 0;
    double time_s = 0.0;
    ObjectPose pose;
    CellFlow cells;
  };

  /// Adds an entry; frames in order. A lost object has no entry in that frame.
  void add(std::uint32_t id, Entry entry) { entries_[id].push_back(std::move(entry)); }
  /// Drops entries that no window of `frame` or a later frame reaches. The last entry of a lost
  /// object stays for `keep_lost` frames, because the object rests there.
  void dropBefore(std::uint64_t frame, std::uint64_t keep_lost);

  /// Returns the samples of object `id` at most `lookahead` frames away from `frame`, in nominal
  /// mm.
  [[nodiscard]] MotionWindow window(std::uint32_t id, std::uint64_t frame, int lookahead,
                                    const NominalFrame& nominal) const;
  /// Returns the motion of object `id` at the frame of the window `around`. Without an entry there
  /// (lost object) it rests at its last pose.
  [[nodiscard]] Motion motion(std::uint32_t id, const MotionWindow& around, int lookahead,
                              const NominalFrame& nominal) const;
  /// Returns whether all frames of the window around `frame` have measured cells.
  [[nodiscard]] bool hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const;
  /// Returns the grid of `frame`; null if no cells were measured.
  [[nodiscard]] std::shared_ptr<const MotionGrid> grid(std::uint32_t id, std::uint64_t frame,
                                                       int lookahead,
                                                       const NominalFrame& nominal) const;

 private:
  /// Returns the entries at most `lookahead` frames away from `frame`, in order.
  [[nodiscard]] std::vector<const Entry*> around(std::uint32_t id, std::uint64_t frame,
                                                 int lookahead) const;

  std::map<std::uint32_t, std::deque<Entry>> entries_;
};

}  // namespace hapticast::server
