// SPDX-License-Identifier: MIT
// Replies of a Falcon, or of another device in its place: any bytes are accepted, the result is
// within its ranges, and whole frames behind any of them are read.
#include <cstdint>

#include "client/device/falcon/kinematics.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/falcon_bytes.hpp"

namespace hapticast::fuzz::falcon {

HAPTICAST_FUZZ_TARGET("falcon") {
  using namespace hapticast::client;
  FalconParser parser;
  for (std::size_t i = 0; i < size; ++i) {
    const auto reply = parser.push(data[i]);
    if (!reply) continue;
    require(reply->homed <= kAllHomed && reply->buttons <= 0x0F);
    const hapticast::Vec3 angles_rad = falconAngles_rad(reply->encoders);
    const auto position_m = falconForward_m(angles_rad, kFalconCentre_m);
    require(!position_m || position_m->norm() < 0.25);
  }
  const FalconReply last{{-1, 300, -700}, 2, kAllHomed};
  int found = 0;
  for (int i = 0; i < 2; ++i) {  // the first one may be taken for the end of another
    for (const std::uint8_t byte : hapticast::testing::encodeReply(last))
      found += parser.push(byte) == last ? 1 : 0;
  }
  require(found >= 1);
  return 0;
}

}  // namespace hapticast::fuzz::falcon
