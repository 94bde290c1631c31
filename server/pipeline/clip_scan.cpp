// SPDX-License-Identifier: MIT
#include "server/pipeline/clip_scan.hpp"

#include <spdlog/spdlog.h>

namespace hapticast::server {

namespace {
constexpr Duration kTellEvery = std::chrono::seconds(2);  // chosen: a comfortable interval
}  // namespace

bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const std::atomic<bool>& stop, const ScanProgress& progress) {
  MediaTime logged = clock.now();
  return vision.scan(source, [&](std::uint64_t done, std::uint64_t total) {
    const double share = static_cast<double>(done) / static_cast<double>(total);
    if (progress) progress(share);
    if (stop || clock.now() - logged < kTellEvery) return !stop;
    logged = clock.now();
    spdlog::info("looking through the clip: {:.0f} %", 100.0 * share);
    return true;
  });
}

}  // namespace hapticast::server
