// SPDX-License-Identifier: MIT
// Says once which depths become heights, and when the object takes little of them. Thread: the
// pipeline's.
#pragma once

#include <optional>

#include "server/vision/surface/range.hpp"

namespace hapticast::server {

class DepthRangeLog {
 public:
  /// `mapped`: nullopt while it is not known.
  void log(const std::optional<MappedRange>& mapped);

 private:
  bool logged_ = false;
};

}  // namespace hapticast::server
