// SPDX-License-Identifier: MIT
#include "server/stream/udp_subscribers.hpp"

#include <algorithm>
#include <vector>

namespace hapticast::server {

std::uint64_t UdpSubscribers::add(const asio::ip::address& peer, const asio::ip::address& local) {
  std::uint64_t token = makeUnguessable();
  while (viewers_.contains(token)) token = makeUnguessable();
  Viewer& viewer = viewers_[token];
  viewer.peer = unmapAddress(peer);
  viewer.local = unmapAddress(local);
  return token;
}

DatagramCounts UdpSubscribers::remove(std::uint64_t token) {
  const auto found = viewers_.find(token);
  if (found == viewers_.end()) return {};
  const DatagramCounts counts = *found->second.counts;
  viewers_.erase(found);
  return counts;
}

DatagramCounts UdpSubscribers::restart(std::uint32_t stream) {
  const DatagramCounts sum = counts();
  viewers_.clear();
  stream_ = stream;
  return sum;
}

UdpSubscribers::Viewer* UdpSubscribers::find(std::uint64_t token) {
  const auto found = viewers_.find(token);
  return found == viewers_.end() ? nullptr : &found->second;
}

void UdpSubscribers::setDelivery(std::uint64_t token, const Delivery& delivery) {
  Viewer* const viewer = find(token);
  if (viewer == nullptr) return;
  viewer->wanted = delivery.datagrams;
  viewer->copies = delivery.copies;
  viewer->by_group = !delivery.datagrams && !delivery.on_tcp;
}

AddressValidation UdpSubscribers::onEcho(std::span<const std::uint8_t> bytes,
                                         const asio::ip::udp::endpoint& from, LocalTime now) {
  const auto echo = readEcho(bytes);
  if (!echo) return AddressValidation::kMalformed;
  if (echo->stream != stream_) return AddressValidation::kOtherStream;
  Viewer* const viewer = find(echo->token);
  if (viewer == nullptr) return AddressValidation::kUnknownToken;
  if (unmapAddress(from.address()) != viewer->peer) return AddressValidation::kForeign;
  if (viewer->at && now - viewer->received < kLeastPause) return AddressValidation::kTooSoon;
  viewer->at = from;
  viewer->received = now;
  return AddressValidation::kValidated;
}

void UdpSubscribers::forget(LocalTime now) {
  for (auto& each : viewers_) {
    Viewer& viewer = each.second;
    if (viewer.at && now - viewer.received >= kForgetAfter) viewer.at.reset();
  }
}

bool UdpSubscribers::hasSubscribers() const {
  return std::any_of(viewers_.begin(), viewers_.end(),
                     [](const auto& each) { return each.second.at && each.second.wanted; });
}

DatagramCounts UdpSubscribers::counts() const {
  DatagramCounts sum;
  for (const auto& each : viewers_) sum += *each.second.counts;
  return sum;
}

std::uint32_t UdpSubscribers::groupCopies() const {
  std::vector<std::uint32_t> wanted;
  wanted.reserve(viewers_.size());
  for (const auto& each : viewers_) {
    if (each.second.by_group) wanted.push_back(each.second.copies);
  }
  if (wanted.empty()) return 1;
  std::sort(wanted.begin(), wanted.end());
  return wanted[(wanted.size() * 9 + 9) / 10 - 1];
}

}  // namespace hapticast::server
