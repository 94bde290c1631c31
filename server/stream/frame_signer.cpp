// SPDX-License-Identifier: MIT
#include "server/stream/frame_signer.hpp"

#include <utility>

#include "common/protocol/fragment.hpp"
#include "common/protocol/signed_frame.hpp"
#include "common/transport/datagram.hpp"

namespace hapticast::server {

FrameSigner::FrameSigner(SigningKey key, std::unique_ptr<DatagramSealer> sealer)
    : key_(std::move(key)), sealer_(std::move(sealer)) {
  identity_.stream = static_cast<std::uint32_t>(makeUnguessable());
  identity_.verifying_key = key_.verifyingKey();
  identity_.probe = probeBody(identity_.stream, key_);
  identity_.sealed = sealer_ != nullptr;
  if (sealer_) identity_.datagram_key = sealer_->firstKey();
}

std::optional<DatagramKey> FrameSigner::rotateKey() {
  return sealer_ ? sealer_->rotate() : std::nullopt;
}

void FrameSigner::revokeKey() {
  if (sealer_) sealer_->revoke();
}

SignedDatagrams FrameSigner::signDatagrams(const CodedFrame& frame) {
  const auto payloads = packFrame(frame);
  if (payloads.empty()) return nullptr;
  auto bodies = std::make_shared<std::vector<std::vector<std::uint8_t>>>();
  bodies->reserve(payloads.size());
  DatagramHeader header{identity_.stream, frame.epoch, frame.id,
                        frame.media_time, 0,           static_cast<std::uint16_t>(payloads.size())};
  SealingKey* const seal = sealer_ ? &sealer_->key() : nullptr;
  const std::lock_guard lock(mutex_);
  const LocalTime begin = now();
  for (const auto& payload : payloads) {
    bodies->push_back(signedBody(header, payload, key_, seal));
    ++header.part;
  }
  addTime(begin);
  return bodies;
}

SharedBytes FrameSigner::signMessage(const CodedFrame& frame) {
  const std::lock_guard lock(mutex_);
  const LocalTime begin = now();
  SharedBytes message = encodeSigned(frame, identity_.stream, key_);
  addTime(begin);
  return message;
}

StageTime FrameSigner::signingTime() const { return {Duration(signing_ns_), signings_}; }

void FrameSigner::addTime(LocalTime begin) {
  if (clock_ == nullptr) return;
  signing_ns_ += (clock_->now() - begin).count();
  ++signings_;
}

Signature FrameSigner::sign(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  return key_.sign(bytes);
}

}  // namespace hapticast::server
