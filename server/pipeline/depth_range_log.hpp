// SPDX-License-Identifier: MIT
// Logs once the mapped range, with a warning if the object covers little of it. Thread: the
// pipeline's.
#pragma once

#include <optional>

#include "server/vision/surface/range.hpp"

namespace hapticast::server {

/// Logger of one stream.
class DepthRangeLog {
 public:
  /// Logs the range at the first call with a value. `mapped`: nullopt if unknown.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
