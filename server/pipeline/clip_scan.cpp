// SPDX-License-Identifier: MIT
#include "server/pipeline/clip_scan.hpp"

#include <spdlog/spdlog.h>
#include <vector>

#include "server/source/scale/picture_scale.hpp"

namespace hapticast::server {

namespace {

constexpr double kOnePlace_px = 3.0;  // chosen: precision of a pointing person

void removeContradictions(VisionSettings& settings) {
  std::erase_if(settings.object_points, [&settings](const AuthorPoint& on) {
    const auto there = [&on](const AuthorPoint& off) {
      return off.time_s == on.time_s && (off.at_px - on.at_px).norm() < kOnePlace_px;
    };
    if (std::erase_if(settings.not_points, there) == 0) return false;
    spdlog::warn("--object {:g},{:g}@{:g} and --not contradict each other; the server ignores both",
                 on.at_px.x(), on.at_px.y(), on.time_s);
    return true;
  });
}

void removeLatePoints(VisionSettings& settings, const SourceInfo& info) {
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
}

}  // namespace

VisionSettings preparePoints(VisionSettings settings, const SourceInfo& info) {
  removeContradictions(settings);
  if (!info.live && info.frame_count) removeLatePoints(settings, info);
  for (auto* points : {&settings.object_points, &settings.not_points}) {
    for (AuthorPoint& point : *points) point.at_px = point.at_px.cwiseQuotient(info.own_px);
  }
  if (settings.camera) settings.camera = scaleCamera(*settings.camera, info);
  return settings;
}

bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const ScanProgress& progress) {
  constexpr Duration kLogInterval = std::chrono::seconds(2);  // chosen: a comfortable interval
  MediaTime logged = clock.now();
  return vision.scan(source, [&](std::uint64_t done, std::uint64_t total) {
    const double share = static_cast<double>(done) / static_cast<double>(total);
    if (progress && !progress(share)) return false;
    if (clock.now() - logged < kLogInterval) return true;
    logged = clock.now();
    spdlog::info("scanning the clip: {:.0f} %", 100.0 * share);
    return true;
  });
}

}  // namespace hapticast::server
