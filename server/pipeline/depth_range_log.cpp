// SPDX-License-Identifier: MIT
#include "server/pipeline/depth_range_log.hpp"

#include <spdlog/spdlog.h>

namespace hapticast::server {

void DepthRangeLog::log(const std::optional<MappedRange>& mapped) {
  if (logged_ || !mapped) return;
  logged_ = true;
  const DepthRange& range = mapped->range;
  if (mapped->usual_mm <= 0) {
    spdlog::info("depths of {:.0f} to {:.0f} mm become heights, as given", range.near_mm,
                 range.far_mm);
    return;
  }
  spdlog::info(
      "depths of {:.0f} to {:.0f} mm become heights; in a usual frame the object takes "
      "{:.0f} mm",
      range.near_mm, range.far_mm, mapped->usual_mm);
  if (!mapped->wide) return;
  spdlog::warn(
      "the object takes {:.0f} % of the heights: it moves in depth, or its mask holds what "
      "is not its own; --not U,V on what does not belong to it, or --map-range NEAR,FAR, "
      "makes it taller",
      100.0 * mapped->usual_mm / (range.far_mm - range.near_mm));
}

}  // namespace hapticast::server
