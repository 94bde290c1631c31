// SPDX-License-Identifier: MIT
// A fuzz target has two uses. With libFuzzer (HAPTICAST_LIBFUZZER) it is a program of its own. In
// every other build it is a row in the table of the one program that replays the corpora.
#pragma once

#include <cstdint>
#include <cstdlib>

#ifdef HAPTICAST_LIBFUZZER
/// Begins the function that reads one input: `data` and `size`. It returns 0.
#define HAPTICAST_FUZZ_TARGET(name) \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define HAPTICAST_FUZZ_TARGET(name)                                           \
  static int runTarget(const std::uint8_t* data, std::size_t size);           \
  static const bool kIsInTable = hapticast::fuzz::addTarget(name, runTarget); \
  static int runTarget(const std::uint8_t* data, std::size_t size)
#endif

namespace hapticast::fuzz {

using Target = int (*)(const std::uint8_t* data, std::size_t size);

/// Adds a target to the table of the replay program; returns true. Thread: the one of main(),
/// before main() begins.
bool addTarget(const char* name, Target target) noexcept;

/// Ends the program as a crash unless `condition` holds.
inline void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace hapticast::fuzz
