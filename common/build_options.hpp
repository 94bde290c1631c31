// SPDX-License-Identifier: MIT
// Optional parts of this build. CMake defines each macro as 1 if it found the package, else as 0
// (hapticast_optional in CMakeLists.txt). A source file that needs an optional package encloses all
// its code in #if with that macro.
#pragma once

namespace hapticast {

inline constexpr bool kHasFalcon = HAPTICAST_LIBUSB != 0;
inline constexpr bool kHasSound = HAPTICAST_SDL2 != 0;
inline constexpr bool kHasWindow = HAPTICAST_IMGUI != 0;
inline constexpr bool kHasDiscovery = HAPTICAST_AVAHI != 0;
inline constexpr bool kHasRelays = HAPTICAST_NATS != 0;
inline constexpr bool kHasOpenni = HAPTICAST_OPENNI2 != 0;

}  // namespace hapticast
