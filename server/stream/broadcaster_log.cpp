// SPDX-License-Identifier: MIT
// Log lines of the Broadcaster, rate-limited. Thread: io.
#include <spdlog/spdlog.h>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

bool Broadcaster::log(spdlog::level::level_enum level, std::string_view line) {
  ServerLogLimiter& limit = level >= spdlog::level::warn ? problems_ : comings_and_goings_;
  if (!limit.allow(clock_.now())) return false;
  const std::uint64_t hidden = limit.popSuppressed();
  spdlog::log(level, "{}{}", line,
              hidden > 0 ? " (and " + std::to_string(hidden) + " lines more, not shown)" : "");
  return true;
}

void Broadcaster::logHidden() {
  for (ServerLogLimiter* limit : {&comings_and_goings_, &problems_}) {
    if (limit->suppressed() == 0 || !(stopped_ || limit->refill(clock_.now()))) continue;
    const std::uint64_t hidden = limit->popSuppressed();
    (void)limit->allow(clock_.now());
    spdlog::info(
        "not shown: {} more about {}", hidden,
        limit == &problems_ ? "connections that were closed" : "viewers that came and went");
  }
}

void Broadcaster::logSlowViewers(LocalTime now) {
  if (now - logged_slow_ < kTellAgainAfter) return;
  const StreamCounts all = counts();
  if (all.sent.dropped() == logged_.dropped()) return;
  const bool told = log(
      spdlog::level::warn,
      fmt::format("slow viewers: dropped {} frames (newer ones came), {} (too old), {} pictures; "
                  "{} viewers",
                  all.sent.frames_dropped_full - logged_.frames_dropped_full,
                  all.sent.frames_dropped_old - logged_.frames_dropped_old,
                  all.sent.videos_dropped - logged_.videos_dropped, all.clients));
  if (!told) return;
  logged_ = all.sent;
  logged_slow_ = now;
}

void Broadcaster::logDatagrams(LocalTime now) {
  if (datagrams_ == nullptr || now - logged_datagrams_at_ < kTellAgainAfter) return;
  const DatagramSenderCounts all = datagrams_->counts();
  const std::uint64_t lost = all.lost() - logged_datagrams_.lost();
  const std::uint64_t wrong = all.notBelieved() - logged_datagrams_.notBelieved();
  if (lost + wrong == 0) return;
  const bool told =
      log(spdlog::level::warn,
          fmt::format("datagrams: {} were not sent, as the network took too few; {} echoes were "
                      "not a viewer's own",
                      lost, wrong));
  if (!told) return;
  logged_datagrams_ = all;
  logged_datagrams_at_ = now;
}

bool Broadcaster::tooLarge(const EncodedFrame& frame) {
  const bool too_large = frame.delta->size() > kMaxMessageBytes;
  const LocalTime now = clock_.now();
  if ((too_large || frame.too_many_datagrams) && now - logged_large_ >= kTellAgainAfter &&
      log(spdlog::level::warn,
          fmt::format("a frame of {} kB, more than {}", frame.delta->size() / 1000,
                      too_large ? "viewers take: it is left out"
                                : "datagrams carry: it goes by TCP only"))) {
    logged_large_ = now;
  }
  return too_large;
}

}  // namespace hapticast::server
