// SPDX-License-Identifier: MIT
#include "client/net/udp/transport_selector.hpp"

#include <algorithm>
#include <utility>

#include "client/net/frame_assembler.hpp"

namespace hapticast::client {

namespace {

std::string inWords(Way way) {
  constexpr std::array<const char*, kWayNames.size()> kHow{"by multicast", "by UDP", "over TCP"};
  return kHow[static_cast<std::size_t>(way)];
}

}  // namespace

DeliveryChoice::DeliveryChoice(std::vector<Way> ways) : ways_(std::move(ways)) { begin(0); }

void DeliveryChoice::begin(std::size_t at) {
  at_ = at;
  works_ = doubted_ = probed_ = false;
  only_tcp_since_.reset();
  narrow_since_.reset();
}

bool DeliveryChoice::newer(std::uint64_t id) const {
  return id > newest_ || FrameAssembler::jump(newest_, id);
}

void DeliveryChoice::impossible(const std::string& why, LocalTime now) {
  const Way failed = way();
  if (failed == Way::kTcp) return;
  failed_at_ = now;
  begin(at_ + 1);
  // A way that is tried again and fails again is no news.
  if (std::find(told_.begin(), told_.end(), failed) != told_.end()) return;
  told_.push_back(failed);
  news_ = "no frames come " + inWords(failed) + " (" + why + "): taking them " + inWords(way()) +
          (way() == Way::kTcp ? ", trying again every 30 s" : "");
}

void DeliveryChoice::wholeFrame(std::uint64_t id, LocalTime now) {
  if (newer(id)) newest_ = id;
  came_at_ = now;
  only_tcp_since_.reset();
  doubted_ = false;
  // Where a datagram of full size does not get through, frames will be missing.
  if (!probed_ && !narrow_since_) narrow_since_ = now;
  if (works_ || !probed_) return;
  works_ = true;
  if (at_ == 0 && !std::exchange(told_, {}).empty())
    news_ = "frames come " + inWords(way()) + " again";
}

void DeliveryChoice::tcpFrame(std::uint64_t id, LocalTime now) {
  if (way() != Way::kTcp && newer(id) && !only_tcp_since_) only_tcp_since_ = now;
}

void DeliveryChoice::turn(LocalTime now, std::uint32_t copies) {
  copies_ = copies;
  if (works_ && now - came_at_ >= kPatience) {
    // Either nothing is sent, or it does not arrive: TCP will tell.
    works_ = false;
    doubted_ = true;
    only_tcp_since_.reset();
  }
  const Duration patience = doubted_ ? kRace : kPatience;
  if (only_tcp_since_ && now - *only_tcp_since_ >= patience)
    impossible(probed_ ? "they are lost" : "does a firewall hold them back?", now);
  if (!probed_ && narrow_since_ && now - *narrow_since_ >= kProbePatience)
    impossible("datagrams of full size do not get through", now);
  if (at_ > 0 && now - failed_at_ >= kTryAgain) begin(0);
}

Delivery DeliveryChoice::wanted() const {
  return {.on_tcp = !works_, .datagrams = way() == Way::kDatagrams, .copies = copies_};
}

std::optional<Delivery> DeliveryChoice::order() {
  if (ordered_ && *ordered_ == wanted()) return std::nullopt;
  ordered_ = wanted();
  return ordered_;
}

std::optional<std::string> DeliveryChoice::news() {
  if (news_.empty()) return std::nullopt;
  return std::exchange(news_, {});
}

}  // namespace hapticast::client
