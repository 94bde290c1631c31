// SPDX-License-Identifier: MIT
// The broadcaster's connections that are no viewers: their places, and who leaves first.
#include <fmt/core.h>
#include <spdlog/common.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

void Broadcaster::accept(std::unique_ptr<Channel> channel) {
  const auto session = std::make_shared<Session>(
      io_, std::move(channel), static_cast<SessionHost&>(*this), ++last_session_id_);
  session->start();
  addPending(session);
  if (stopped_) session->close(serverEnds());
}

void Broadcaster::addPending(const std::shared_ptr<Session>& session) {
  addWithin(pending_sessions_, session, settings_.max_pending, "connections that are not viewers");
}

void Broadcaster::addWithin(Sessions& list, const std::shared_ptr<Session>& session,
                            std::size_t most, std::string_view what) {
  list.push_back(session);
  if (list.size() <= most || stopped_) return;  // at shutdown all receive a goodbye
  const std::shared_ptr<Session> peer = evictionCandidate(list);
  ++counts_.refused;
  log(spdlog::level::warn, fmt::format("too many {}: closing {}", what, peer->label()));
  peer->abort();
}

std::shared_ptr<Session> Broadcaster::evictionCandidate(const Sessions& list) {
  std::unordered_map<std::string_view, std::size_t> from;
  for (const auto& each : list) ++from[each->network()];
  const auto most = std::max_element(
      from.begin(), from.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  // Among networks with equally many sessions, the oldest session is the candidate.
  return *std::find_if(list.begin(), list.end(),
                       [&](const auto& each) { return from[each->network()] == most->second; });
}

void Broadcaster::onRequest(const std::shared_ptr<Session>& session, const std::string& problem) {
  std::erase(pending_sessions_, session);
  if (!problem.empty()) {
    ++counts_.refused;
    log(spdlog::level::warn, fmt::format("closing {}: {}", session->label(), problem));
  }
  addWithin(answers_, session, settings_.max_answers, "requests at once");
}

std::optional<LocalTime> Broadcaster::reserveRefusal(const Session& session, LocalTime latest) {
  return refusals_.reserve(session.network(), clock_.now(), latest);
}

}  // namespace hapticast::server
