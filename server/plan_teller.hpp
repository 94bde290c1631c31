// SPDX-License-Identifier: MIT
// --explain: says in the log what is left out of each object, why, what it saves and costs.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/time.hpp"
#include "server/vision/scene_plan.hpp"

namespace hapticast::server {

class PlanTeller {
 public:
  /// Tells the plans that have changed, by object id; one object's at most once a second, because a
  /// change that is taken back at once is not worth a line. Objects that are gone are forgotten.
  void tell(const std::map<std::uint32_t, std::vector<PlanLine>>& plans, MediaTime now);

 private:
  struct ToldPlan {
    std::vector<PlanLine> lines;
    MediaTime at;
  };
  std::map<std::uint32_t, ToldPlan> told_;  // by object id
};

}  // namespace hapticast::server
