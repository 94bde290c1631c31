// SPDX-License-Identifier: MIT
// Subjects of one channel on NATS. Thread: any.
#pragma once

#include <string>

namespace hapticast::server {

/// Subjects of a channel. An edge subscribes to `everything`, so it receives the messages of one
/// origin in their order.
struct Subjects {
  explicit Subjects(const std::string& channel)
      : state("hapticast." + channel + ".origin.state"),
        frames("hapticast." + channel + ".origin.frames"),
        everything("hapticast." + channel + ".origin.*"),
        pings("hapticast." + channel + ".pings") {}
  std::string state;
  std::string frames;  ///< frames and pictures
  std::string everything;
  std::string pings;
};

}  // namespace hapticast::server
