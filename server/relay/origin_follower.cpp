// SPDX-License-Identifier: MIT
#include "server/relay/origin_follower.hpp"

#include <algorithm>
#include <utility>

#include "server/relay/origin_election.hpp"

namespace hapticast::server {

namespace {

FollowedMessage dropMessage(std::string problem = {}) {
  return {std::nullopt, false, std::move(problem)};
}

}  // namespace

Result<TrustedState> readTrustedState(const RelayHead& head, std::span<const std::uint8_t> whole,
                                      const std::vector<KeyBytes>& keys) {
  auto content = decodeRelay(whole);
  if (!content.ok()) return Error{content.error().message};
  auto* const state = std::get_if<RelayState>(&content.value());
  if (state == nullptr) return Error{};
  if (state->stream != static_cast<std::uint32_t>(head.origin))
    return Error{"a state contradicts the number of its origin"};
  if (!keys.empty() && std::find(keys.begin(), keys.end(), state->verifying_key) == keys.end())
    return Error{"an origin has another key than --origin-key"};
  auto key = VerifyingKey::from(state->verifying_key);
  if (!key.ok() || !verifyRelay(whole, key.value())) return Error{"a state has no valid signature"};
  return TrustedState{std::move(*state), std::move(key).value()};
}

FollowedMessage OriginFollower::onMessage(std::span<const std::uint8_t> whole) {
  const auto head = readRelayHead(whole, channel_);
  if (!head.ok()) return dropMessage(head.error().message);
  if (head.value().term > OriginElection::kHighestTerm) return dropMessage("a term is too high");
  const auto order = [](const auto& of) { return std::pair(of.term, of.origin); };
  if (!leader_ || order(head.value()) > order(*leader_)) return onOther(head.value(), whole);
  if (order(head.value()) < order(*leader_)) return dropMessage();
  return onLeader(head.value(), whole);
}

FollowedMessage OriginFollower::onOther(const RelayHead& head,
                                        std::span<const std::uint8_t> whole) {
  auto trusted = readTrustedState(head, whole, keys_);
  // Other messages of a new origin can arrive before its first state.
  if (!trusted.ok()) return dropMessage(trusted.error().message);
  leader_.emplace(
      Leader{head.term, head.origin, head.number, std::move(trusted.value().key), std::nullopt});
  return {std::move(trusted.value().state), true, {}};
}

FollowedMessage OriginFollower::onLeader(const RelayHead& head,
                                         std::span<const std::uint8_t> whole) {
  if (!verifyRelay(whole, leader_->key))
    return dropMessage("a message has no valid signature of its origin");
  auto content = decodeRelay(whole);
  if (!content.ok()) return dropMessage(content.error().message);
  // Pongs have a way of their own, on which they may arrive earlier or later.
  if (std::holds_alternative<RelayPong>(content.value()))
    return {std::move(content).value(), false, {}};
  if (head.number <= leader_->number) return dropMessage("a message arrives twice or too late");
  leader_->number = head.number;
  if (const auto* const frame = std::get_if<RelayFrame>(&content.value())) {
    if (frame->epoch < leader_->epoch || (leader_->frame && frame->id <= *leader_->frame))
      return dropMessage("a frame is older than the one before");
    leader_->epoch = frame->epoch;
    leader_->frame = frame->id;
  }
  return {std::move(content).value(), false, {}};
}

}  // namespace hapticast::server
