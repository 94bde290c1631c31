// SPDX-License-Identifier: MIT
// Writes the log of --explain: for each object, the stages that are on or off, with the reason, the
// time and the change of force. Thread: the pipeline's.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "server/stream/encoded.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/range.hpp"

namespace hapticast::server {

/// Logs the scene plans of all objects at a limited rate.
class PlanLog {
 public:
  /// Logs those of `plans` (by object id) whose decisions changed. It identifies an object by its
  /// position in `plans`, because each playback of a looped clip has new ids. It logs the plan of a
  /// position at most once a second, and equal decisions of a position at most once a minute.
  /// `relief_bytes`: sizes of the reliefs, by object id. While the stage `heights` is off, the log
  /// states these bytes as saved.
  void log(const std::map<std::uint32_t, std::vector<PlanLine>>& plans,
           const ReliefBytes& relief_bytes, MediaTime now);

 private:
  struct Logged {
    std::string newest;                      // decisions, as a text
    std::optional<MediaTime> at;             // time of the last lines
    std::map<std::string, MediaTime> times;  // of all logged decisions
  };
  std::vector<Logged> logged_;  // by place
};

/// Returns the bytes of a hapticast.proto.Plan (proto/recording.proto). `plans`: by object id.
[[nodiscard]] std::vector<std::uint8_t> encodePlan(
    const std::map<std::uint32_t, std::vector<PlanLine>>& plans);

/// Logs the mapped range of one stream, once. Also logs a warning if the object covers only a small
/// part of the range. Thread: the pipeline's.
class DepthRangeLog {
 public:
  /// Logs the mapped range `mapped` once, at the first call in which it is known. `mapped`: nullopt
  /// while the range is unknown.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
