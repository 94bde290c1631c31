// SPDX-License-Identifier: MIT
// Relayed messages: the first byte chooses what the rest is. 0: a whole message of the channel "c"
// without its signature, which the target adds; 1: a ping; else: pieces, each after two bytes of
// length.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "common/protocol/relay.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::relay {
namespace {

void readPieces(std::span<const std::uint8_t> bytes) {
  hapticast::RelayJoiner joiner;
  while (bytes.size() > 2) {
    const std::size_t length = bytes[0] + 256U * bytes[1];
    const auto piece = bytes.subspan(2, std::min(length, bytes.size() - 2));
    const auto whole = joiner.add(piece);
    if (whole.ok() && whole.value() && whole.value()->empty()) std::abort();
    bytes = bytes.subspan(2 + piece.size());
  }
}

void readWhole(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> whole(bytes.begin(), bytes.end());
  whole.resize(whole.size() + hapticast::kSignatureBytes);
  if (!hapticast::readRelayHead(whole, "c", std::chrono::system_clock::time_point()).ok()) return;
  const auto content = hapticast::decodeRelay(whole);
  if (!content.ok()) return;
  // What the decoder accepts, the encoder writes, and the decoder accepts again.
  const auto again = hapticast::encodeRelay("c", {1, 2, 3}, content.value(),
                                            [](auto) { return hapticast::Signature{}; });
  const auto decoded = hapticast::decodeRelay(again);
  if (!decoded.ok() || decoded.value().index() != content.value().index()) std::abort();
}

}  // namespace

HAPTICAST_FUZZ_TARGET("relay") {
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  if (data[0] == 0) {
    readWhole(bytes);
  } else if (data[0] == 1) {
    (void)hapticast::decodeRelayPing(bytes);
  } else {
    readPieces(bytes);
  }
  return 0;
}

}  // namespace hapticast::fuzz::relay
