// SPDX-License-Identifier: MIT
// Log lines of the Broadcaster, rate-limited. Thread: io.
#include <spdlog/spdlog.h>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

bool Broadcaster::log(spdlog::level::level_enum level, std::string_view line) {
  LogRateLimiter& limit = level >= spdlog::level::warn ? problems_ : comings_and_goings_;
  const auto admitted = limit.admit(std::string(line), clock_.now());
  if (admitted) spdlog::log(level, "{}", *admitted);
  return admitted.has_value();
}

void Broadcaster::logHidden() {
  for (LogRateLimiter* limit : {&comings_and_goings_, &problems_}) {
    if (limit->dropped() == 0 || !(stopped_ || limit->isReady(clock_.now()))) continue;
    const std::uint64_t hidden = limit->popDropped();
    (void)limit->allow(clock_.now());
    spdlog::info(
        "not shown: {} more about {}", hidden,
        limit == &problems_ ? "connections that were closed" : "viewers that came and went");
  }
}

void Broadcaster::logSlowViewers(LocalTime now) {
  if (!slow_interval_.isDue(now)) return;
  const StreamCounts all = counts();
  if (all.sent.dropped() == logged_.dropped()) return;
  const bool logged = log(
      spdlog::level::warn,
      fmt::format("slow viewers: dropped {} frames (newer ones came), {} (too old), {} pictures; "
                  "{} viewers",
                  all.sent.frames_dropped_full - logged_.frames_dropped_full,
                  all.sent.frames_dropped_old - logged_.frames_dropped_old,
                  all.sent.videos_dropped - logged_.videos_dropped, all.clients));
  if (!logged) return;
  logged_ = all.sent;
  slow_interval_.onLogged(now);
}

void Broadcaster::logDatagrams(LocalTime now) {
  if (datagrams_ == nullptr || !datagrams_interval_.isDue(now)) return;
  const DatagramSenderCounts all = datagrams_->counts();
  const std::uint64_t lost = all.lost() - logged_datagrams_.lost();
  const std::uint64_t wrong = all.notBelieved() - logged_datagrams_.notBelieved();
  if (lost + wrong == 0) return;
  const bool logged =
      log(spdlog::level::warn,
          fmt::format("datagrams: {} were not sent, as the network took too few; {} echoes were "
                      "not a viewer's own",
                      lost, wrong));
  if (!logged) return;
  logged_datagrams_ = all;
  datagrams_interval_.onLogged(now);
}

bool Broadcaster::tooLarge(const EncodedFrame& frame) {
  const bool too_large = frame.delta->size() > kMaxMessageBytes;
  const LocalTime now = clock_.now();
  if ((too_large || frame.too_many_datagrams) && large_interval_.isDue(now) &&
      log(spdlog::level::warn,
          fmt::format("a frame of {} kB, more than {}", frame.delta->size() / 1000,
                      too_large ? "viewers take: it is left out"
                                : "datagrams carry: it goes by TCP only"))) {
    large_interval_.onLogged(now);
  }
  return too_large;
}

}  // namespace hapticast::server
