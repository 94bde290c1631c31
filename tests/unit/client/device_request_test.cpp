// SPDX-License-Identifier: MIT
#include "client/device/device_request.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(DeviceRequest, ADriverReceivesTheOptionsForAllAndItsOwn) {
  const std::map<std::string, std::string> options{
      {"dhd.serial", "7"}, {"falcon.gain", "4000"}, {"library", "a.so"}, {"serial", "1"}};
  EXPECT_EQ(selectDriverOptions(options, "dhd"),
            (std::map<std::string, std::string>{{"library", "a.so"}, {"serial", "7"}}));
}

}  // namespace
}  // namespace hapticast::client
