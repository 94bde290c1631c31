// SPDX-License-Identifier: MIT
// What was measured of all objects over the frames around the one that is described. Thread:
// vision's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/nominal_frame.hpp"

namespace hapticast::server {

/// The poses of an object over the frames around one, in order of time.
struct MotionWindow {
  std::vector<Sample> samples;
  std::optional<std::size_t> at;  ///< of that frame; nullopt: it was lost there
  ReferencePoint point = ReferencePoint::kVisibleCentroid;  ///< in that frame
};

class MotionHistory {
 public:
  struct Entry {
    std::uint64_t frame = 0;
    double time_s = 0.0;
    ObjectPose pose;
    CellFlow cells;
  };

  /// Frames come in order; an object has no entry in a frame that it is lost in.
  void add(std::uint32_t id, Entry entry) { entries_[id].push_back(std::move(entry)); }
  /// Forgets what no window of a frame from this one on reaches; an object's last entry stays for
  /// `keep_lost` frames, because a lost object rests there.
  void dropBefore(std::uint64_t frame, std::uint64_t keep_lost);

  [[nodiscard]] MotionWindow window(std::uint32_t id, std::uint64_t frame, int lookahead,
                                    const NominalFrame& nominal) const;
  /// Motion of object `id` at the frame that `around` is the window of. Without an entry there
  /// (lost) it rests at its last known pose.
  [[nodiscard]] Motion motion(std::uint32_t id, const MotionWindow& around, int lookahead,
                              const NominalFrame& nominal) const;
  /// Whether cells were measured in all frames of the window around one.
  [[nodiscard]] bool hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const;
  /// The grid of that frame; null where no cells were measured.
  [[nodiscard]] std::shared_ptr<const MotionGrid> grid(std::uint32_t id, std::uint64_t frame,
                                                       int lookahead,
                                                       const NominalFrame& nominal) const;

 private:
  /// Entries at most `lookahead` frames away from one, in order.
  [[nodiscard]] std::vector<const Entry*> around(std::uint32_t id, std::uint64_t frame,
                                                 int lookahead) const;

  std::map<std::uint32_t, std::deque<Entry>> entries_;
};

}  // namespace hapticast::server
