// SPDX-License-Identifier: MIT
// The broadcaster's lines of the log, and their limits.
#include <spdlog/common.h>
#include <spdlog/spdlog.h>

#include <string>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

void Broadcaster::logStatus() const {
  spdlog::info("status: {} viewers, {} frames, delay {:.1f} ms", viewers_.size(), counts_.frames,
               1e3 * toSeconds(counts_.delay));
}

bool Broadcaster::log(spdlog::level::level_enum level, std::string_view line) {
  RateLimiter& limit = level >= spdlog::level::warn ? problems_ : connections_log_limit_;
  const auto admitted = limit.admit(std::string(line), clock_.now());
  if (admitted) spdlog::log(level, "{}", *admitted);
  return admitted.has_value();
}

void Broadcaster::logHidden() {
  for (RateLimiter* limit : {&connections_log_limit_, &problems_}) {
    if (limit->dropped() == 0 || !(stopped_ || limit->isReady(clock_.now()))) continue;
    const std::uint64_t hidden = limit->popDropped();
    (void)limit->allow(clock_.now());
    spdlog::info(
        "not shown: {} more about {}", hidden,
        limit == &problems_ ? "connections that were closed" : "viewers that joined and left");
  }
}

void Broadcaster::logStaleFrames() {
  const std::uint64_t dropped = stale_.dropped() - logged_stale_;
  if (dropped == 0 || !stale_interval_.allow(clock_.now())) return;
  logged_stale_ += dropped;
  log(spdlog::level::warn,
      fmt::format("the stream was interrupted: {} frames left out that were too old when they were "
                  "ready; was the machine suspended or overloaded?",
                  dropped));
}

void Broadcaster::logSlowViewers(LocalTime now) {
  if (!slow_interval_.isReady(now)) return;
  const StreamCounts all = counts();
  if (all.sent.dropped() == logged_.dropped()) return;
  const bool logged =
      log(spdlog::level::warn,
          fmt::format("slow viewers: dropped {} frames (newer frames arrived), {} (too old), {} "
                      "pictures; {} viewers",
                      all.sent.frames_dropped_full - logged_.frames_dropped_full,
                      all.sent.frames_dropped_old - logged_.frames_dropped_old,
                      all.sent.videos_dropped - logged_.videos_dropped, all.clients));
  if (!logged) return;
  logged_ = all.sent;
  (void)slow_interval_.allow(now);
}

void Broadcaster::logDatagrams(LocalTime now) {
  if (datagrams_ == nullptr || !datagrams_interval_.isReady(now)) return;
  const DatagramSenderCounts all = datagrams_->counts();
  const std::uint64_t lost = all.lost() - logged_datagrams_.lost();
  const std::uint64_t wrong = all.rejectedEchoes() - logged_datagrams_.rejectedEchoes();
  if (lost + wrong == 0) return;
  const bool logged =
      log(spdlog::level::warn, fmt::format("datagrams: {} were not sent, because the network "
                                           "accepted too few; {} echoes did not match their viewer",
                                           lost, wrong));
  if (!logged) return;
  logged_datagrams_ = all;
  (void)datagrams_interval_.allow(now);
}

}  // namespace hapticast::server
