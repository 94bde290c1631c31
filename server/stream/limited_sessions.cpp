// SPDX-License-Identifier: MIT
#include "server/stream/limited_sessions.hpp"

#include <algorithm>
#include <string_view>
#include <unordered_map>

namespace hapticast::server {

std::shared_ptr<Session> LimitedSessions::add(const std::shared_ptr<Session>& session) {
  sessions_.push_back(session);
  if (sessions_.size() <= most_) return nullptr;
  std::unordered_map<std::string_view, std::size_t> from;
  for (const auto& each : sessions_) ++from[each->network()];
  const auto most = std::max_element(
      from.begin(), from.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  // Among networks with equally many sessions, the oldest session is the candidate.
  return *std::find_if(sessions_.begin(), sessions_.end(),
                       [&](const auto& each) { return from[each->network()] == most->second; });
}

}  // namespace hapticast::server
