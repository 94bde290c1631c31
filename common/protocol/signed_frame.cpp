// SPDX-License-Identifier: MIT
#include "common/protocol/signed_frame.hpp"

#include <memory>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/protocol/scan.hpp"
#include "hapticast.pb.h"

namespace hapticast {

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Returns the only field with this number in a message. Returns empty bytes for none, or for
/// several: the parser would merge them.
std::span<const std::uint8_t> findField(std::span<const std::uint8_t> message, int number) {
  const auto found = submessages(message, static_cast<std::uint32_t>(number), 1);
  return found && !found->empty() ? found->front() : std::span<const std::uint8_t>();
}

Bytes bytesToSign(std::span<const std::uint8_t> message, std::uint32_t stream) {
  const auto frame = findField(message, proto::Message::kFrameFieldNumber);
  Bytes bytes;
  bytes.reserve(sizeof(stream) + frame.size());
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<std::uint8_t>(stream >> shift));
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  return bytes;
}

}  // namespace

SharedBytes encodeSigned(const CodedFrame& frame, std::uint32_t stream, SigningKey& key) {
  Bytes bytes = encode(frame);
  const Signature signature = key.sign(bytesToSign(bytes, stream));
  // The fields of a message may be concatenated.
  proto::Message signed_part;
  signed_part.set_signature(signature.data(), signature.size());
  const std::size_t size = bytes.size();
  bytes.resize(size + signed_part.ByteSizeLong());
  signed_part.SerializeWithCachedSizesToArray(bytes.data() + size);
  return std::make_shared<const Bytes>(std::move(bytes));
}

bool verifyFrame(std::span<const std::uint8_t> bytes, std::uint32_t stream,
                 const VerifyingKey& key) {
  const auto signature = findField(bytes, proto::Message::kSignatureFieldNumber);
  return signature.size() == kSignatureBytes && key.verify(bytesToSign(bytes, stream), signature);
}

}  // namespace hapticast
