// SPDX-License-Identifier: MIT
// Messages of recordings: the first byte chooses the decoder of the rest.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "client/recording/run_codec.hpp"
#include "common/protocol/recorded.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::recorded {
namespace {

/// What a decoder accepts, the encoder writes, and the decoder accepts again.
template <class Decode, class Encode>
void check(std::span<const std::uint8_t> bytes, Decode decode, Encode encode) {
  const auto decoded = decode(bytes);
  if (decoded.ok() && !decode(encode(decoded.value())).ok()) std::abort();
}

}  // namespace

HAPTICAST_FUZZ_TARGET("recorded") {
  using namespace hapticast::client;
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  switch (data[0] % 9) {
    case 0:
      (void)hapticast::decodeFrameContent(bytes);
      break;
    case 1:
      (void)hapticast::decodeDescriptionContent(bytes);
      break;
    case 2:
      check(bytes, hapticast::decodePictureContent, hapticast::encodePictureContent);
      break;
    case 3:
      check(bytes, decodeTicks, [](const auto& ticks) { return encodeTicks(ticks); });
      break;
    case 4:
      check(bytes, decodeReceivedFrame, encodeFrame);
      break;
    case 5:
      check(bytes, decodePreparation, encodePreparation);
      break;
    case 6:
      check(bytes, decodeTiming, encodeTiming);
      break;
    case 7:
      check(bytes, decodeControls, encodeControls);
      break;
    default:
      check(bytes, decodeSettings, encodeSettings);
  }
  return 0;
}

}  // namespace hapticast::fuzz::recorded
