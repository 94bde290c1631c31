// SPDX-License-Identifier: MIT
// Writes the log of --explain: which stages are off for each object, with the reason, the saved
// time and the change of force. Thread: the pipeline's.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "server/stream/encoded.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/range.hpp"

namespace hapticast::server {

/// Logs the scene plans of all objects at a limited rate.
class PlanLog {
 public:
  /// Logs those of `plans` (by object id) that changed. It logs each object at most once a second,
  /// and the same plan of an object at most once a minute. It does not log a new object whose plan
  /// equals that of a vanished object, because each playback of a looped clip has new ids.
  /// `relief_bytes`: sizes of the reliefs, by object id. The log states them as saved while the
  /// stage `heights` is off.
  void log(const std::map<std::uint32_t, std::vector<PlanLine>>& plans,
           const ReliefBytes& relief_bytes, MediaTime now);

 private:
  using Lines = std::vector<PlanLine>;
  struct LoggedLines {
    Lines lines;
    MediaTime at;
  };
  struct LoggedPlan {
    Lines lines;  // newest plan of the object
    MediaTime at;
    std::vector<LoggedLines> all;  // logged plans, without duplicates
  };
  /// Returns whether the newest plan of `logged` has to be logged. If it has, marks the plan as
  /// logged at `now`.
  bool isNews(LoggedPlan& logged, MediaTime now) const;
  void retire(LoggedPlan plan);

  std::map<std::uint32_t, LoggedPlan> logged_;  // newest plans, by object id
  std::deque<Lines> retired_;                   // plans of vanished objects, oldest first
};

/// Logs the mapped range of one stream, once. Adds a warning if the object covers only a small part
/// of it. Thread: the pipeline's.
class DepthRangeLog {
 public:
  /// Logs the mapped range `mapped` once, at the first call in which it is known. `mapped`: nullopt
  /// while the range is unknown.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
