// SPDX-License-Identifier: MIT
#include "server/stream/datagram_signer.hpp"

#include <memory>

namespace hapticast::server {

DatagramSigner::DatagramSigner()
    : stream_(static_cast<std::uint32_t>(unguessable())), probe_(probeBody(stream_, key_)) {}

SignedDatagrams DatagramSigner::sign(const CodedFrame& frame) {
  const auto payloads = packFrame(frame);
  if (payloads.empty()) return nullptr;
  auto bodies = std::make_shared<std::vector<std::vector<std::uint8_t>>>();
  bodies->reserve(payloads.size());
  DatagramHeader header{stream_,          frame.epoch, frame.id,
                        frame.media_time, 0,           static_cast<std::uint16_t>(payloads.size())};
  for (const auto& payload : payloads) {
    bodies->push_back(signedBody(header, payload, key_));
    ++header.part;
  }
  return bodies;
}

}  // namespace hapticast::server
