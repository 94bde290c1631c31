// SPDX-License-Identifier: MIT
// From tracked objects to the descriptor: nominal units, the window around a frame, what changed.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "server/vision/motion/impact.hpp"
#include "server/vision/motion/window.hpp"
#include "server/vision/surface/layers.hpp"
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
    double quality = 1.0;
  };
  /// The poses of an object over the frames around one, in order of time.
  struct Window {
    std::vector<Sample> samples;
    std::optional<std::size_t> at;  ///< of that frame; nullopt: it was lost there
    ReferencePoint point = ReferencePoint::kVisibleCentroid;  ///< in that frame
  };

  /// Frames come in order; lost objects have no entry.
  void add(std::uint64_t frame, double time_s, const std::vector<TrackedObject>& objects);
  void dropBefore(std::uint64_t frame);

  [[nodiscard]] Window window(std::uint32_t id, std::uint64_t frame, int lookahead,
                              const NominalFrame& nominal) const;
  /// Motion of object `id` at the frame that `around` is the window of. Without an entry there
  /// (lost) it rests at its last known pose.
  [[nodiscard]] Motion motion(std::uint32_t id, const Window& around, int lookahead,
                              const NominalFrame& nominal) const;
  /// Whether cells were measured in all frames of the window around one.
  [[nodiscard]] bool hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const;
  [[nodiscard]] std::shared_ptr<const MotionGrid> grid(std::uint32_t id, std::uint64_t frame,
                                                       int lookahead,
                                                       const NominalFrame& nominal) const;

 private:
  std::map<std::uint32_t, std::deque<Entry>> entries_;
};

/// Of an object that is seen and followed; carried on without being seen well is below.
inline constexpr double kGoodQuality = 0.75;

/// What a clip's largest acceleration is announced as: the 0.99 quantile, because the one largest
/// of hundreds of measured values is the worst of their noise. 0 when empty. Reorders.
double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2);

/// The object as it enters the descriptor; its motion comes later, with the window. `last`: the
/// same object in the frame before, or null; an unchanged relief keeps its pointer and its
/// changed_in_frame.
HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings);

/// The same cut into layers where its depth steps; not in the thesis's method. `last`: all objects
/// of the frame before. What is entirely at rest or lost is taken from there.
std::vector<HapticObject> describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                                         const std::vector<HapticObject>& last,
                                         const DepthNoise& noise, const NominalFrame& nominal,
                                         const VisionSettings& settings, LayerCutter& cutter);

}  // namespace hapticast::server
