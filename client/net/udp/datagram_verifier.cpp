// SPDX-License-Identifier: MIT
#include "client/net/udp/datagram_verifier.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

DatagramCounts DatagramCounts::operator+(const DatagramCounts& other) const {
  return {received + other.received, repeated + other.repeated, foreign + other.foreign,
          astray + other.astray,     forged + other.forged,     over_budget + other.over_budget};
}

DatagramVerifier::DatagramVerifier(std::uint64_t token, std::uint32_t stream, VerifyingKey key)
    : token_(token), stream_(stream), key_(std::move(key)) {}

std::optional<Datagram> DatagramVerifier::verify(std::span<const std::uint8_t> bytes, LocalTime now,
                                                 const IsWanted& want) {
  const auto datagram = readDatagram(bytes);
  if (!datagram || datagram->token != token_ || datagram->header.stream != stream_) {
    ++counts_.foreign;
    return std::nullopt;
  }
  using Want = FrameAssembler::Want;
  const Want wanted = datagram->header.probe() ? Want::kNew : want(datagram->header);
  if (wanted != Want::kNew) {
    ++(wanted == Want::kHad ? counts_.repeated : counts_.astray);
    return std::nullopt;
  }
  if (!mayVerify(now)) {
    ++counts_.over_budget;
    return std::nullopt;
  }
  if (!key_.verify(datagram->signed_bytes, datagram->signature)) {
    ++counts_.forged;
    return std::nullopt;
  }
  ++counts_.received;
  return datagram;
}

bool DatagramVerifier::mayVerify(LocalTime now) {
  const LocalTime latest = std::max(budget_at_.value_or(now), now);
  const double since_s = toSeconds(latest - budget_at_.value_or(latest));
  budget_at_ = latest;
  budget_ = std::min(kBurst, budget_ + kVerifications_Hz * since_s);
  if (budget_ < 1.0) return false;
  budget_ -= 1.0;
  return true;
}

}  // namespace hapticast::client
