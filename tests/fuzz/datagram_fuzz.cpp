// SPDX-License-Identifier: MIT
// Datagrams: no bytes crash who reads them, and accepted ones can be rendered and sent on. The
// input is bodies of one frame, each behind two bytes that say how long it is; what is mutated is
// signed here, so that it gets beyond the signature. No mutation opens a seal, and what is sealed
// here is opened unchanged.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "common/protocol/messages.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::datagram {
namespace {

using namespace hapticast;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kBeforePayload = kDatagramHeaderBytes - kTokenBytes;

Bytes datagramOf(std::span<const std::uint8_t> body, SigningKey& key) {
  const Signature signature = key.sign(body);
  Bytes bytes(kTokenBytes + body.size() + signature.size(), 7);
  std::copy(body.begin(), body.end(), bytes.begin() + kTokenBytes);
  std::copy(signature.begin(), signature.end(), bytes.end() - kSignatureBytes);
  return bytes;
}

/// A seal is a guess of 128 bits.
void expectShut(const Datagram& datagram, const OpeningKey& key) {
  require(datagram.payload.empty() && datagram.sealed.size() >= kSealTagBytes);
  Bytes payload(datagram.sealed.size() - kSealTagBytes);
  require(!key.open(datagram.counter, datagram.readable, datagram.sealed, payload));
}

/// Whatever has been read is the same behind a seal.
void sealAndOpen(const Datagram& datagram, SigningKey& signer) {
  static SealingKey seal(1);
  static const OpeningKey key(seal.bytes());
  if (datagram.header.probe() || datagram.payload.size() > kMostPieceBytes) return;
  Bytes bytes = signedBody(datagram.header, datagram.payload, signer, &seal);
  bytes.insert(bytes.begin(), kTokenBytes, 7);
  const auto sealed = readDatagram(bytes);
  require(sealed && sealed->key_id == 1 && sealed->header == datagram.header);
  Bytes payload(datagram.payload.size());
  require(key.open(sealed->counter, sealed->readable, sealed->sealed, payload));
  require(std::equal(payload.begin(), payload.end(), datagram.payload.begin()));
}

/// A joined frame is like any other, without the reliefs that did not arrive.
void sendOn(CodedFrame frame) {
  for (CodedObject& object : frame.objects) {
    if (object.relief && object.relief->slices.empty()) object.relief = nullptr;
  }
  require(decode(encode(frame)).ok());
  const auto payloads = packFrame(frame);
  require(!payloads.empty());
  Reassembly again(
      {0, frame.epoch, frame.id, frame.media_time, 0, static_cast<std::uint16_t>(payloads.size())});
  DatagramHeader header = again.header();
  for (const Bytes& payload : payloads) {
    require(payload.size() <= kMostPieceBytes);
    require(!again.add(header, payload));
    ++header.part;
  }
  require(again.whole() && again.hasHead());
}

}  // namespace

HAPTICAST_FUZZ_TARGET("datagram") {
  static SigningKey key(KeyBytes{});
  static const OpeningKey shut(SealKeyBytes{});
  static const VerifyingKey verifying = VerifyingKey::from(key.verifyingKey()).value();
  std::span<const std::uint8_t> rest(data, size);
  (void)readDatagram(rest);
  (void)readEcho(rest);
  std::optional<Reassembly> joined;
  while (rest.size() >= 2) {
    const std::size_t wanted = rest[0] + 256U * rest[1];
    rest = rest.subspan(2);
    const auto body = rest.first(std::min(wanted, rest.size()));
    rest = rest.subspan(body.size());
    const Bytes bytes = datagramOf(body, key);
    const auto datagram = readDatagram(bytes);
    if (!datagram) continue;
    require(body.size() >= kBeforePayload);
    require(verifying.verify(datagram->signed_bytes, datagram->signature));
    if (datagram->key_id != kPlainKeyId) {
      expectShut(*datagram, shut);
      continue;
    }
    sealAndOpen(*datagram, key);
    if (datagram->header.probe()) continue;
    if (!joined) joined.emplace(datagram->header);
    if (!joined->lacks(datagram->header)) continue;
    if (joined->add(datagram->header, datagram->payload)) return 0;  // the frame is given up
  }
  if (!joined) return 0;
  sendOn(joined->frame());
  return 0;
}

}  // namespace hapticast::fuzz::datagram
