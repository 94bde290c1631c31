// SPDX-License-Identifier: MIT
// The last acts of operators, for other operators: each sees who acted last, and when. It keeps two
// acts, of two operators. So there is one of another operator for everybody. Thread: the network's.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "common/protocol/messages.hpp"
#include "server/stream/limited_sessions.hpp"
#include "server/stream/session.hpp"

namespace hapticast::server {

/// Requests of operators that were carried out.
class OperatorActs {
 public:
  /// Adds `act` of the operator `sender`, in place of the act before of the same operator.
  void add(const std::weak_ptr<Session>& sender, const Control& act) {
    std::erase_if(acts_, [&](const Act& each) { return each.sender.lock() == sender.lock(); });
    if (acts_.size() == 2) acts_.erase(acts_.begin());
    acts_.push_back({sender, encodeShared(act)});
  }
  /// Sends the newest act of another operator to each of `viewers` that receives acts, unless an
  /// earlier call has sent it. Call it at most once a second, which is the rate limit of acts.
  void sendTo(const Sessions& viewers) {
    if (std::all_of(acts_.begin(), acts_.end(), [](const Act& each) { return each.sent; })) return;
    for (const auto& viewer : viewers) {
      if (!viewer->wantsActs()) continue;
      const auto act = std::find_if(acts_.rbegin(), acts_.rend(),
                                    [&](const Act& each) { return each.sender.lock() != viewer; });
      if (act != acts_.rend() && !act->sent) viewer->send(act->payload);
    }
    for (Act& each : acts_) each.sent = true;
  }
  /// Returns the newest act as a message; null if there is none.
  [[nodiscard]] SharedBytes newest() const {
    return acts_.empty() ? nullptr : acts_.back().payload;
  }

 private:
  struct Act {
    std::weak_ptr<Session> sender;
    SharedBytes payload;
    bool sent = false;
  };
  std::vector<Act> acts_;  // the newest at the end
};

}  // namespace hapticast::server
