// SPDX-License-Identifier: MIT
// Wrong values of camera:N,M, on a machine without cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Camera, AMissingDeviceIsNamed) {
  EXPECT_THAT(openError("camera:91,92"),
              AllOf(HasSubstr("/dev/video91: cannot be opened (No such file"),
                    HasSubstr("are /dev/video*")));
}

TEST(Camera, DepthIsAskedFor) {
  EXPECT_THAT(openError("camera:3"),
              AllOf(HasSubstr("colour and depth are needed"), HasSubstr("camera:N,M")));
}

TEST(Camera, NumbersAreChecked) {
  for (const char* spec : {"camera:", "camera:x", "camera:-1,2", "camera:1,", "camera:1,2,3",
                           "camera:1,2x", "camera:99999999999,1"}) {
    EXPECT_THAT(openError(spec), AllOf(HasSubstr(spec), HasSubstr("is not a camera number")))
        << spec;
  }
}

}  // namespace
}  // namespace hapticast::server
