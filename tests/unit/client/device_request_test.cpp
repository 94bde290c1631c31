// SPDX-License-Identifier: MIT
#include "client/device/device_request.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(DeviceRequest, ADriverReceivesTheOptionsForAllAndItsOwn) {
  const SteadyClock clock;
  const DeviceRequest request{
      .kind = "dhd",
      .clock = clock,
      .options = {
          {"dhd.serial", "7"}, {"falcon.gain", "4000"}, {"library", "a.so"}, {"serial", "1"}}};
  EXPECT_EQ(selectDriverOptions(request),
            (std::map<std::string, std::string>{{"library", "a.so"}, {"serial", "7"}}));
}

}  // namespace
}  // namespace hapticast::client
