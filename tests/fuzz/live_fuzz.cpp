// SPDX-License-Identifier: MIT
// Requests of a live watcher: any text is decoded or refused, and an encoded request decodes as it
// was.
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/live/live_protocol.hpp"
#include "common/live/watcher.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::live {

HAPTICAST_FUZZ_TARGET("live") {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)hapticast::isTrustedPage(text, "127.0.0.1");
  const auto request = hapticast::decodeLiveRequest(text);
  if (!request) return 0;
  if (!request->begin.empty() && !request->end.empty()) std::abort();
  nlohmann::json list = nlohmann::json::array();
  for (const auto& each : request->begin)
    list.push_back({{"id", each.number}, {"channelId", each.channel}});
  for (const std::uint32_t number : request->end) list.push_back(number);
  const bool ends = !request->end.empty();
  const auto again = hapticast::decodeLiveRequest(nlohmann::json{
      {"op", ends ? "unsubscribe" : "subscribe"},
      {ends ? "subscriptionIds" : "subscriptions",
       list}}.dump());
  if (text.size() < hapticast::kMostRequestBytes / 4 && again != request) std::abort();
  return 0;
}

}  // namespace hapticast::fuzz::live
