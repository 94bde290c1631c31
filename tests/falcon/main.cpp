// SPDX-License-Identifier: MIT
// The tests below libusb need umockdev's preload library in front: without it this program starts
// itself again with it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "tests/falcon/usb_port.hpp"

int main(int argc, char** argv) {
  const char* const before = std::getenv("LD_PRELOAD");
  const std::string preload = before == nullptr ? "" : before;
  if (preload.find("libumockdev-preload") == std::string::npos) {
    setenv("LD_PRELOAD",
           (preload + (preload.empty() ? "" : ":") + "libumockdev-preload.so.0").c_str(), 1);
    // The preload library stands in front of the sanitizer's.
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0:detect_leaks=0", 0);
    execv("/proc/self/exe", argv);
  }
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
