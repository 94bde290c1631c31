// SPDX-License-Identifier: MIT
#include "server/stream/stream_log.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <string>

namespace hapticast::server {

bool StreamLog::log(spdlog::level::level_enum level, std::string_view line, LocalTime now) {
  RateLimiter& limit = level >= spdlog::level::warn ? problems_ : others_;
  const auto admitted = limit.admit(std::string(line), now);
  if (admitted) spdlog::log(level, "{}", *admitted);
  return admitted.has_value();
}

void StreamLog::logHidden(LocalTime now, bool ends) {
  for (RateLimiter* limit : {&others_, &problems_}) {
    if (limit->dropped() == 0 || !(ends || limit->isReady(now))) continue;
    const std::uint64_t hidden = limit->popDropped();
    (void)limit->allow(now);
    spdlog::info(
        "not shown: {} more about {}", hidden,
        limit == &problems_ ? "connections that were closed" : "viewers that joined and left");
  }
}

void StreamLog::logStaleFrames(std::uint64_t dropped, LocalTime now) {
  const std::uint64_t fresh = dropped - logged_stale_;
  if (fresh == 0 || !stale_interval_.allow(now)) return;
  logged_stale_ = dropped;
  log(spdlog::level::warn,
      fmt::format("the stream was interrupted: {} frames left out that were too old when they were "
                  "ready; was the machine suspended or overloaded?",
                  fresh),
      now);
}

void StreamLog::logSlowViewers(const StreamCounts& all, LocalTime now) {
  if (!slow_interval_.isReady(now) || all.sent.dropped() == logged_.dropped()) return;
  const bool logged =
      log(spdlog::level::warn,
          fmt::format("slow viewers: dropped {} frames (newer frames arrived), {} (too old), {} "
                      "pictures; {} viewers",
                      all.sent.frames_dropped_full - logged_.frames_dropped_full,
                      all.sent.frames_dropped_old - logged_.frames_dropped_old,
                      all.sent.videos_dropped - logged_.videos_dropped, all.clients),
          now);
  if (!logged) return;
  logged_ = all.sent;
  (void)slow_interval_.allow(now);
}

void StreamLog::logDatagrams(const DatagramSenderCounts& all, LocalTime now) {
  if (!datagrams_interval_.isReady(now)) return;
  const std::uint64_t lost = all.lost() - logged_datagrams_.lost();
  const std::uint64_t wrong = all.rejectedEchoes() - logged_datagrams_.rejectedEchoes();
  if (lost + wrong == 0) return;
  const bool logged =
      log(spdlog::level::warn,
          fmt::format("datagrams: {} were not sent, because the network accepted too few; {} "
                      "echoes did not match their viewer",
                      lost, wrong),
          now);
  if (!logged) return;
  logged_datagrams_ = all;
  (void)datagrams_interval_.allow(now);
}

void StreamLog::logLargeFrame(std::size_t bytes, bool too_large, LocalTime now) {
  if (!large_interval_.isReady(now)) return;
  const bool logged =
      log(spdlog::level::warn,
          fmt::format("a frame of {} kB, more than {}", bytes / 1000,
                      too_large ? "viewers accept: the server leaves it out"
                                : "datagrams carry: the server sends it by TCP only"),
          now);
  if (logged) (void)large_interval_.allow(now);
}

}  // namespace hapticast::server
