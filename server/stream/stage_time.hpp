// SPDX-License-Identifier: MIT
// Total time of a stage of the pipeline since the server's start. Thread: any.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace hapticast::server {

/// Sum of the durations of one stage.
struct StageTime {
  Duration sum{0};
  std::uint64_t count = 0;  ///< number of durations

  void add(Duration duration) {
    sum += duration;
    ++count;
  }
};

}  // namespace hapticast::server
