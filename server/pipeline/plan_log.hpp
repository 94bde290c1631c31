// SPDX-License-Identifier: MIT
// --explain: says in the log what is left out of each object, why, what it saves and costs.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "common/time.hpp"
#include "server/stream/encoded.hpp"
#include "server/vision/scene_plan.hpp"

namespace hapticast::server {

class PlanLog {
 public:
  /// Tells the plans that have changed, by object id; one object's at most once a second, because a
  /// change that is taken back at once is not worth a line, and the same plan at most once a
  /// minute. What was told of an object that is gone is not told again of its successors: a clip
  /// that loops has new ones every round.
  /// `relief_bytes`: what leaving heights out saves.
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
    std::vector<LoggedLines> all;  // that were told of it, each once
  };
  /// Whether its newest plan is to be told; then it counts as told.
  bool isNews(LoggedPlan& logged, MediaTime now) const;
  void retire(LoggedPlan plan);

  std::map<std::uint32_t, LoggedPlan> logged_;  // by object id
  std::deque<Lines> retired_;                   // of objects that are gone, oldest first
};

}  // namespace hapticast::server
