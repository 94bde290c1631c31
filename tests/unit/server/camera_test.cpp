// SPDX-License-Identifier: MIT
// Cameras as a source: what is said where there is none (a test machine has none).
#include "server/source/camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Camera, AMissingDeviceIsNamed) {
  EXPECT_THAT(openError("camera:91,92"),
              AllOf(HasSubstr("/dev/video91: no such camera"), HasSubstr("see /dev/video*")));
}

TEST(Camera, DepthIsAskedFor) {
  EXPECT_THAT(openError("camera:3"), AllOf(HasSubstr("depth is needed"), HasSubstr("camera:3,M")));
}

TEST(Camera, NumbersAreChecked) {
  for (const char* spec : {"camera:", "camera:x", "camera:-1,2", "camera:1,", "camera:1,2,3",
                           "camera:1,2x", "camera:99999999999,1"}) {
    EXPECT_THAT(openError(spec), AllOf(HasSubstr(spec), HasSubstr("is no camera number"))) << spec;
  }
}

}  // namespace
}  // namespace hapticast::server
