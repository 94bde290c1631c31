// SPDX-License-Identifier: MIT
// Log of --explain: the inactive stages of each object, with reason, saved time and cost in force.
// Thread: the pipeline's.
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

/// Rate-limited log of all objects' plans.
class PlanLog {
 public:
  /// Logs changed plans by object id: one object at most once a second, and an equal plan at most
  /// once a minute.
  /// A plan of a vanished object is not logged again for later objects, because each round of a
  /// looped clip has new ids. `relief_bytes`: bytes saved without heights.
  void log(const std::map<std::uint32_t, std::vector<PlanLine>>& plans,
           const ReliefBytes& relief_bytes, MediaTime now);

 private:
  using Lines = std::vector<PlanLine>;
  struct LoggedLines {
    Lines lines;
    MediaTime at;
  };
  struct LoggedPlan {
    Lines lines;  // the newest
    MediaTime at;
    std::vector<LoggedLines> all;  // logged plans, without duplicates
  };
  /// Returns whether the newest plan is to be logged; then marks it as logged.
  bool isNews(LoggedPlan& logged, MediaTime now) const;
  void retire(LoggedPlan plan);

  std::map<std::uint32_t, LoggedPlan> logged_;  // by object id
  std::deque<Lines> retired_;                   // plans of vanished objects, oldest first
};

// Logs once the mapped range, with a warning if the object covers little of it. Thread: the
// pipeline's.

/// Logger of one stream.
class DepthRangeLog {
 public:
  /// Logs the range at the first call with a value. `mapped`: nullopt if unknown.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
