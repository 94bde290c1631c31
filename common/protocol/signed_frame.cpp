// SPDX-License-Identifier: MIT
#include "common/protocol/signed_frame.hpp"

#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/protocol/scan.hpp"

namespace hapticast {

namespace {

using Bytes = std::vector<std::uint8_t>;

// Fields of proto::Message.
constexpr std::uint32_t kFrameField = 6;
constexpr std::uint32_t kSignatureField = 12;
// Tag (number * 8 + 2) and length of the field `signature`, which is written behind the frame.
constexpr std::uint8_t kSignatureHead[] = {kSignatureField * 8 + 2, kSignatureBytes};

/// Returns the only field with this number in a message. Returns empty bytes for none, or for
/// several: the parser would merge them.
std::span<const std::uint8_t> findField(std::span<const std::uint8_t> message,
                                        std::uint32_t number) {
  const auto found = submessages(message, number, 1);
  return found && !found->empty() ? found->front() : std::span<const std::uint8_t>();
}

Bytes bytesToSign(std::span<const std::uint8_t> message, std::uint32_t stream) {
  const auto frame = findField(message, kFrameField);
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
  bytes.insert(bytes.end(), std::begin(kSignatureHead), std::end(kSignatureHead));
  bytes.insert(bytes.end(), signature.begin(), signature.end());
  return std::make_shared<const Bytes>(std::move(bytes));
}

bool verifyFrame(std::span<const std::uint8_t> bytes, std::uint32_t stream,
                 const VerifyingKey& key) {
  const auto signature = findField(bytes, kSignatureField);
  return signature.size() == kSignatureBytes && key.verify(bytesToSign(bytes, stream), signature);
}

}  // namespace hapticast
