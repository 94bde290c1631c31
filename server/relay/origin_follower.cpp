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

FollowedMessage OriginFollower::onMessage(std::span<const std::uint8_t> whole, LocalTime now,
                                          std::chrono::system_clock::time_point utc) {
  const auto head = readRelayHead(whole, channel_, utc);
  if (!head.ok()) return dropMessage(head.error().message);
  if (!seen_.isNew(head.value().origin, head.value().number))
    return dropMessage("a message arrives twice or too late");
  if (!isOfRank(head.value(), now)) return dropMessage();
  const bool is_leader = leader_ && head.value().origin == leader_->origin;
  return is_leader ? onLeader(head.value(), whole, now) : onOther(head.value(), whole, now);
}

bool OriginFollower::mayCount(std::span<const std::uint8_t> begin, LocalTime now,
                              std::chrono::system_clock::time_point utc) {
  const auto head = readRelayHead(begin, channel_, utc);
  return head.ok() && seen_.isNew(head.value().origin, head.value().number) &&
         isOfRank(head.value(), now);
}

bool OriginFollower::isOfRank(const RelayHead& head, LocalTime now) {
  // An origin may raise its own term. Its stream goes on.
  if (leader_ && head.origin == leader_->origin) return head.term >= leader_->term;
  const auto order = [](const auto& of) { return std::pair(of.term, of.origin); };
  const bool lost_rank = leader_ && keys_.empty() && now - leader_->received >= kLoseRankAfter;
  if (!leader_ || lost_rank || order(head) > order(*leader_)) return true;
  rival_ = true;
  return false;
}

FollowedMessage OriginFollower::onOther(const RelayHead& head, std::span<const std::uint8_t> whole,
                                        LocalTime now) {
  if (!checks_.allow(now)) return dropMessage(kTooManyMessages);
  auto trusted = readTrustedState(head, whole, keys_);
  // Other messages of a new origin can arrive before its first state.
  if (!trusted.ok()) return dropMessage(trusted.error().message);
  const bool leader_sends = leader_ && now - leader_->received < OriginElection::kSilence;
  if (leader_sends && !changes_.allow(now))
    return dropMessage("the edge has left an origin that still sends in the last minute");
  seen_.add(head.origin, head.number);
  leader_.emplace(Leader{head.term,
                         head.origin,
                         std::move(trusted.value().key),
                         now,
                         {whole.begin(), whole.end()},
                         std::nullopt});
  rival_ = false;
  return {std::move(trusted.value().state), true, {}};
}

FollowedMessage OriginFollower::onLeader(const RelayHead& head, std::span<const std::uint8_t> whole,
                                         LocalTime now) {
  if (!checks_.allow(now)) return dropMessage(kTooManyMessages);
  if (!verifyRelay(whole, leader_->key))
    return dropMessage("a message has no valid signature of its origin");
  auto content = decodeRelay(whole);
  if (!content.ok()) return dropMessage(content.error().message);
  if (std::holds_alternative<RelayPong>(content.value()))
    return dropMessage("a pong among the messages for all edges");
  leader_->received = now;
  leader_->term = head.term;
  seen_.add(head.origin, head.number);
  if (std::holds_alternative<RelayState>(content.value()))
    leader_->state.assign(whole.begin(), whole.end());
  if (const auto* const frame = std::get_if<RelayFrame>(&content.value())) {
    if (frame->epoch < leader_->epoch || (leader_->frame && frame->id <= *leader_->frame))
      return dropMessage("a frame is older than the one before");
    leader_->epoch = frame->epoch;
    leader_->frame = frame->id;
  }
  return {std::move(content).value(), false, {}};
}

std::optional<RelayPong> OriginFollower::readPong(
    std::span<const std::uint8_t> whole, std::chrono::system_clock::time_point utc,
    const std::function<bool(LocalTime t0)>& is_expected) const {
  const auto head = readRelayHead(whole, channel_, utc);
  if (!leader_ || !head.ok() || head.value().origin != leader_->origin) return std::nullopt;
  const auto content = decodeRelay(whole);
  if (!content.ok()) return std::nullopt;
  const auto* const pong = std::get_if<RelayPong>(&content.value());
  if (pong == nullptr || !is_expected(pong->t0) || !verifyRelay(whole, leader_->key))
    return std::nullopt;
  return *pong;
}

std::vector<std::uint8_t> OriginFollower::popProof() {
  const bool rival = std::exchange(rival_, false);
  return rival && leader_ ? leader_->state : std::vector<std::uint8_t>();
}

}  // namespace hapticast::server
