// SPDX-License-Identifier: MIT
#include "client/report/haptic_status_log.hpp"

#include <fmt/core.h>

namespace hapticast::client {

namespace {

bool acted(const TickReport& report, SafetyAction which) {
  return (report.interferences & bit(which)) != 0;
}

/// Returns true for the first time, and again after a minute.
bool due(std::optional<LocalTime>& told, LocalTime now) {
  if (told && now - *told < LogRateLimiter::kWhile) return false;
  told = now;
  return true;
}

std::string comesBack(const RearmPolicy& rearm) {
  if (rearm.left() > 0)
    return fmt::format("for 5 s, which is forgiven {} more {}", rearm.left(),
                       rearm.left() == 1 ? "time" : "times");
  if (rearm.manual()) return "until R is pressed in the window";
  return rearm.automatic() ? "from now on; start again to touch it"
                           : "from now on; start again, or with --rearm, to touch it";
}

std::string halted(const TickReport& report, const RearmPolicy& rearm) {
  if (report.halt == Halt::kDeviceLost) {
    const char* const until = rearm.automatic() ? "until it is back"
                              : rearm.manual()  ? "until it is back and R is pressed in the window"
                                                : "from now on (--rearm brings it back)";
    return fmt::format("the device does not answer: no force {}", until);
  }
  if (report.halt == Halt::kUnconfirmed)
    return fmt::format(
        "the client detected this device automatically: no force until {}its re-arming "
        "button is pressed; --rearm or --device confirm it as well",
        rearm.manual() ? "R in the window or " : "");
  return fmt::format(
      "the stream is not trusted any more, too much of it had to be held back (mostly: {}): no "
      "force {}",
      toText(report.trust_loss_cause), comesBack(rearm));
}

}  // namespace

std::optional<std::string> HapticStatusLog::onReport(const TickReport& report,
                                                     const RearmPolicy& rearm) {
  if (report.halt != halt_) {
    halt_ = report.halt;
    if (halt_ == Halt::kStopped) return std::nullopt;
    return halt_limit_.allow(
        halt_ == Halt::kNone ? "re-armed: the force comes back" : halted(report, rearm),
        report.time);
  }
  std::string line = describeStatus(report);
  if (line.empty()) return std::nullopt;
  return limit_.allow(std::move(line), report.time);
}

std::string HapticStatusLog::describeStatus(const TickReport& report) {
  if (!report.enabled && !logged_enable_) {
    logged_enable_ = true;
    return "the device's enabling button is not held: no force until it is, and whenever it is let "
           "go";
  }
  const bool stale = report.lookup == Lookup::kStale;
  const bool fresh = report.lookup == Lookup::kInterpolated;
  if (stale && !stale_) {
    stale_ = true;
    return "no new frames come: the force has faded";
  }
  if (fresh && stale_) {
    stale_ = false;
    return "frames come again";
  }
  if (acted(report, SafetyAction::kStiffness) && due(logged_softer_, report.time))
    return "a wall is softer than the stream asks for: --stiffness-limit or the device limits it";
  if (acted(report, SafetyAction::kLatency) && due(logged_later_, report.time))
    return "the device answers later than its profile says: walls are softer";
  return "";
}

}  // namespace hapticast::client
