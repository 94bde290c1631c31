// SPDX-License-Identifier: MIT
#include "server/stream/frame_signer.hpp"

#include "common/protocol/fragment.hpp"
#include "common/protocol/signed_frame.hpp"
#include "common/transport/datagram.hpp"

namespace hapticast::server {

FrameSigner::FrameSigner()
    : stream_(static_cast<std::uint32_t>(unguessable())), probe_(probeBody(stream_, key_)) {}

SignedDatagrams FrameSigner::signDatagrams(const CodedFrame& frame) {
  const auto payloads = packFrame(frame);
  if (payloads.empty()) return nullptr;
  auto bodies = std::make_shared<std::vector<std::vector<std::uint8_t>>>();
  bodies->reserve(payloads.size());
  DatagramHeader header{stream_,          frame.epoch, frame.id,
                        frame.media_time, 0,           static_cast<std::uint16_t>(payloads.size())};
  const std::lock_guard lock(mutex_);
  for (const auto& payload : payloads) {
    bodies->push_back(signedBody(header, payload, key_));
    ++header.part;
  }
  return bodies;
}

SharedBytes FrameSigner::signMessage(const CodedFrame& frame) {
  const std::lock_guard lock(mutex_);
  return encodeSigned(frame, stream_, key_);
}

void FrameSigner::introduce(Welcome& welcome) const {
  welcome.stream = stream_;
  welcome.verifying_key = key_.verifyingKey();
}

}  // namespace hapticast::server
