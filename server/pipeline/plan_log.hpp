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
  /// Logs those plans (by object id) that changed. It logs an object at most once a second, and an
  /// equal plan of it at most once a minute. A later object with the plan of a vanished one is not
  /// logged again. The reason is that each playback of a looped clip has new ids. `relief_bytes`:
  /// sizes of the reliefs, which are saved while the stage `heights` is off.
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
  /// Returns whether the newest plan has to be logged, and if so, marks it as logged.
  bool isNews(LoggedPlan& logged, MediaTime now) const;
  void retire(LoggedPlan plan);

  std::map<std::uint32_t, LoggedPlan> logged_;  // newest plans, by object id
  std::deque<Lines> retired_;                   // plans of vanished objects, oldest first
};

// Logs the mapped range once. It adds a warning if the object covers only a small part of it.
// Thread: the pipeline's.

/// Logs the mapped range of one stream.
class DepthRangeLog {
 public:
  /// Logs the mapped range at the first call with a value. `mapped`: nullopt if it is not known
  /// yet.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
