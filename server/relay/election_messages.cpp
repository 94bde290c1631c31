// SPDX-License-Identifier: MIT
#include "server/relay/election_messages.hpp"

namespace hapticast::server {

std::string ElectionMessages::onHeartbeat(std::span<const std::uint8_t> whole, LocalTime now,
                                          std::chrono::system_clock::time_point utc) {
  const auto head = readRelayHead(whole, channel_, utc);
  if (!head.ok()) return head.error().message;
  const auto [term, origin, number] = head.value();
  // NATS does not return this connection's own messages.
  if (origin == election_.origin()) return "somebody sends the number of this origin";
  if (!election_.isRanked(term, origin) || !seen_.isNew(origin, number)) return {};
  if (!checks_.allow(now)) return kTooManyMessages;
  const auto state = readTrustedState(head.value(), whole, keys_);
  if (!state.ok())
    return state.error().message.empty() ? "they are no states" : state.error().message;
  seen_.add(origin, number);
  election_.onHeartbeat(term, origin, now);
  return {};
}

void ElectionMessages::onProof(std::span<const std::uint8_t> whole, LocalTime now,
                               std::chrono::system_clock::time_point utc) {
  const auto head = readRelayHead(whole, channel_, utc);
  if (!head.ok() || head.value().origin == election_.origin()) return;
  if (!election_.isTermNew(head.value().term) || !checks_.allow(now)) return;
  if (readTrustedState(head.value(), whole, keys_).ok())
    election_.onProvedTerm(head.value().term, now);
}

}  // namespace hapticast::server
