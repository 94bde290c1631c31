// SPDX-License-Identifier: MIT
#include "client/device/buttons.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(DeviceButtons, ArePassedOnOncePerPress) {
  DeviceProfile profile;
  profile.pause_button = 2;
  profile.rearm_button = 0;
  DeviceButtons buttons(profile);
  EXPECT_TRUE(buttons.onButtons(0b0100).pause);
  EXPECT_FALSE(buttons.onButtons(0b0100).pause) << "it is held";
  const DeviceButtons::ButtonActions both = buttons.onButtons(0b0101);
  EXPECT_TRUE(both.rearm && !both.pause && !both.other);
  (void)buttons.onButtons(0);
  EXPECT_TRUE(buttons.onButtons(0b0100).pause);
  EXPECT_EQ(buttons.onButtons(0b1100).other, 3);
}

TEST(DeviceButtons, WithoutAMeaningNothingIsSent) {
  static DeviceProfile dead_man;  // GCC 14 warns of the unset bytes of an empty optional
  dead_man.enable_button = 1;
  DeviceButtons buttons(dead_man);
  const DeviceButtons::ButtonActions wish = buttons.onButtons(0b1111);
  EXPECT_FALSE(wish.pause || wish.rearm || wish.other);
}

}  // namespace
}  // namespace hapticast::client
