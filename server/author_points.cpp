// SPDX-License-Identifier: MIT
#include "server/author_points.hpp"

#include <spdlog/spdlog.h>

#include <vector>

namespace hapticast::server {

VisionSettings withinClip(VisionSettings settings, const SourceInfo& info) {
  if (info.live || !info.frame_count) return settings;
  const double end_s = static_cast<double>(*info.frame_count) / info.fps;
  const auto check = [end_s](const char* flag, std::vector<AuthorPoint>& points) {
    std::erase_if(points, [&](const AuthorPoint& point) {
      if (point.time_s < end_s) return false;
      spdlog::warn(
          "{} {:g},{:g}@{:g}: after the end of the clip, which lasts {:.4g} s; it is left "
          "out",
          flag, point.at_px.x(), point.at_px.y(), point.time_s, end_s);
      return true;
    });
  };
  check("--object", settings.object_points);
  check("--not", settings.not_points);
  return settings;
}

}  // namespace hapticast::server
