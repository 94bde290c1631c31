// SPDX-License-Identifier: MIT
#include "client/net/udp/transport_selector.hpp"

#include <algorithm>
#include <utility>

#include "client/net/frame_assembler.hpp"

namespace hapticast::client {

namespace {

std::string toText(Transport transport) {
  constexpr std::array<const char*, kWayNames.size()> kHow{"by multicast", "by UDP", "over TCP"};
  return kHow[static_cast<std::size_t>(transport)];
}

}  // namespace

TransportSelector::TransportSelector(std::vector<Transport> transports)
    : transports_(std::move(transports)) {
  begin(0);
}

void TransportSelector::begin(std::size_t at) {
  at_ = at;
  works_ = suspected_ = probed_ = false;
  only_tcp_since_.reset();
  narrow_since_.reset();
}

bool TransportSelector::isNewer(std::uint64_t id) const {
  return id > newest_ || FrameAssembler::jump(newest_, id);
}

void TransportSelector::markFailed(const std::string& why, LocalTime now) {
  const Transport failed = transport();
  if (failed == Transport::kTcp) return;
  failed_at_ = now;
  begin(at_ + 1);
  // A repeated failure of the same transport is no news.
  if (std::find(logged_.begin(), logged_.end(), failed) != logged_.end()) return;
  logged_.push_back(failed);
  messages_ = "no frames arrive " + toText(failed) + " (" + why + "): the client receives them " +
              toText(transport()) +
              (transport() == Transport::kTcp ? " and tries again every 30 s" : "");
}

void TransportSelector::onCompleteFrame(std::uint64_t id, LocalTime now) {
  if (isNewer(id)) newest_ = id;
  received_at_ = now;
  only_tcp_since_.reset();
  suspected_ = false;
  // Without full-size datagrams frames will be incomplete.
  if (!probed_ && !narrow_since_) narrow_since_ = now;
  if (works_ || !probed_) return;
  works_ = true;
  if (at_ == 0 && !std::exchange(logged_, {}).empty())
    messages_ = "frames arrive " + toText(transport()) + " again";
}

void TransportSelector::tcpFrame(std::uint64_t id, LocalTime now) {
  if (transport() != Transport::kTcp && isNewer(id) && !only_tcp_since_) only_tcp_since_ = now;
}

void TransportSelector::update(LocalTime now, std::uint32_t copies, Duration frame_interval) {
  copies_ = copies;
  if (works_ && now - received_at_ >= std::max(kSilence, kSilentFrames * frame_interval)) {
    // Either the server sends nothing, or nothing arrives. Frames over TCP will show the
    // difference.
    works_ = false;
    suspected_ = true;
    only_tcp_since_.reset();
  }
  const Duration patience = suspected_ ? kRace : kPatience;
  if (only_tcp_since_ && now - *only_tcp_since_ >= patience)
    markFailed(probed_ ? "the network loses them" : "does a firewall block them?", now);
  if (!probed_ && narrow_since_ && now - *narrow_since_ >= kProbePatience)
    markFailed("datagrams of full size do not arrive", now);
  if (at_ > 0 && now - failed_at_ >= kTryAgain) begin(0);
}

Delivery TransportSelector::wanted() const {
  return {.on_tcp = !works_, .datagrams = transport() == Transport::kDatagrams, .copies = copies_};
}

std::optional<Delivery> TransportSelector::takeRequest() {
  if (ordered_ && *ordered_ == wanted()) return std::nullopt;
  ordered_ = wanted();
  return ordered_;
}

std::optional<std::string> TransportSelector::nextMessage() {
  if (messages_.empty()) return std::nullopt;
  return std::exchange(messages_, {});
}

}  // namespace hapticast::client
