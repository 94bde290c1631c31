// SPDX-License-Identifier: MIT
#include "client/report/messages.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <cmath>
#include <utility>

namespace hapticast::client {

std::string greeting(const StreamDescription& stream, Method method) {
  std::string text = fmt::format("connected: {}, {} x {}, {:g} frames/s", stream.name,
                                 stream.workspace.width_px, stream.workspace.height_px, stream.fps);
  if (method == Method::kThesis && stream.method != Method::kThesis) {
    text +=
        "; the client uses --method thesis, but the server does not: the server keeps its own "
        "segmentation, smoothing, motion and workspace";
  }
  return text;
}

std::optional<std::string> ConnectionLog::connected(const std::string& greeting, LocalTime now) {
  ever_connected_ = true;
  reason_.clear();
  logged_share_.reset();
  return limit_.admit(greeting, now);
}

std::optional<std::string> ConnectionLog::preparing(double share, LocalTime now) {
  if (share >= 1.0 || (logged_share_ && share < *logged_share_ + 0.25)) return std::nullopt;
  logged_share_ = share;
  return limit_.admit(
      "the server scans its clip first: " + std::to_string(std::lround(100.0 * share)) + " % done",
      now);
}

std::optional<std::string> ConnectionLog::logLoss(const std::string& why, LocalTime now) {
  if (why != reason_) lost_interval_ = RateLimiter::makeOnceAMinute();
  if (!lost_interval_.allow(now)) return std::nullopt;
  reason_ = why;
  return limit_.admit(ever_connected_ ? server_ + ": " + why + "; trying again"
                                      : "waiting for a server at " + server_ + " (" + why + ")",
                      now);
}

std::optional<std::string> StreamErrorLog::onCounts(const ReceiverCounts& counts, LocalTime now) {
  if (!interval_.isReady(now)) return std::nullopt;
  std::string text;
  const auto add = [&](std::uint64_t count, std::uint64_t logged, const char* what) {
    if (count > logged)
      text += (text.empty() ? "" : "; ") + (what + std::to_string(count - logged));
  };
  add(counts.contradictions, logged_.contradictions,
      "two versions of a frame that differ, so there is no force until the next connection: ");
  add(counts.reliefs_rejected, logged_.reliefs_rejected,
      "reliefs outside the announced picture or too high, whose objects are not shown: ");
  add(counts.slices_refused, logged_.slices_refused, "slices of heights that cannot be decoded: ");
  add(counts.resyncs, logged_.resyncs, "jumps of the frame ids (each restarts the contact): ");
  add(counts.reliefs_missing, logged_.reliefs_missing,
      "objects without a shape, which are not shown: ");
  add(counts.overrun + counts.no_slot, logged_.overrun + logged_.no_slot,
      "frames that arrived faster than the client renders them and were dropped: ");
  if (text.empty()) return std::nullopt;
  logged_ = counts;
  (void)interval_.allow(now);
  return "server error: " + text;
}

std::optional<std::string> LateFrameLog::onCounts(const ReceiverCounts& counts, LocalTime now) {
  if (second_begin_ && now - *second_begin_ < std::chrono::seconds(1)) return std::nullopt;
  const bool first = !second_begin_;
  const std::uint64_t received = counts.received - second_.received;
  const std::uint64_t too_late = counts.too_late - second_.too_late;
  second_ = counts;
  second_begin_ = now;
  constexpr std::uint64_t kFew = 5;  // chosen: a pause delays one frame
  if (first || received < kFew || 2 * too_late <= received || !interval_.allow(now))
    return std::nullopt;
  return fmt::format(
      "frames arrive later than the largest playout delay ({:g} ms): the stream counts as "
      "interrupted; a larger --max-delay shows it, if the network is not at fault",
      max_delay_ms_);
}

namespace {

bool hasActed(const TickReport& report, SafetyAction which) {
  return (report.safety_actions & bit(which)) != 0;
}

std::string comesBack(const RearmPolicy& rearm) {
  if (rearm.left() > 0)
    return fmt::format("for 5 s; the client re-arms it automatically {} more {}", rearm.left(),
                       rearm.left() == 1 ? "time" : "times");
  if (rearm.manual()) return "until you press R in the window";
  return rearm.automatic() ? "from now on; restart the client to touch this stream"
                           : "from now on; restart the client to touch this stream (--rearm "
                             "restores the force automatically)";
}

std::string halted(const TickReport& report, const RearmPolicy& rearm) {
  if (report.halt == Halt::kDeviceLost) {
    const char* const until = rearm.automatic() ? "until it answers again"
                              : rearm.manual()
                                  ? "until it answers again and you press R in the window"
                                  : "from now on (--rearm restores the force automatically)";
    return fmt::format("the device does not answer: no force {}", until);
  }
  if (report.halt == Halt::kUnconfirmed)
    return fmt::format(
        "the client detected this device automatically: no force until {}its re-arming "
        "button is pressed; --rearm or --device confirm it as well",
        rearm.manual() ? "R in the window or " : "");
  return fmt::format(
      "the client does not trust the stream any more, because the safety chain acted too often "
      "(mostly: {}): no force {}",
      toText(report.trust_loss_cause), comesBack(rearm));
}

// Longer than a join by any transport and a first key frame need.
constexpr Duration kPatience = std::chrono::seconds(3);
// Chosen: the user notices a force that is off for so long.
constexpr Duration kDeepLong = std::chrono::milliseconds(300);

}  // namespace

std::vector<std::string> HapticStatusLog::onReport(const TickReport& report,
                                                   const RearmPolicy& rearm) {
  std::vector<std::string> lines;
  addHalt(report, rearm, lines);
  addStates(report, lines);
  if (!lines.empty()) return lines;
  std::string line = describeStatus(report);
  if (line.empty()) return lines;
  if (auto admitted = limit_.admit(std::move(line), report.time))
    lines.push_back(*std::move(admitted));
  return lines;
}

/// Adds the line of a halt. A device that is lost again within 10 s, such as one with a loose plug,
/// adds none.
void HapticStatusLog::addHalt(const TickReport& report, const RearmPolicy& rearm,
                              std::vector<std::string>& lines) {
  if (report.halt == halt_) return;
  const bool flaps = report.halt == Halt::kDeviceLost && lost_before_ &&
                     (states_ & bit(SafetyState::kForceOff)) != 0;
  halt_ = report.halt;
  if (halt_ == Halt::kStopped) return;
  if (halt_ == Halt::kNone) {
    if (!flaps_) lines.emplace_back("re-armed: the force returns");
    return;
  }
  flaps_ = flaps;
  lost_before_ = halt_ == Halt::kDeviceLost;
  if (!flaps) lines.push_back(halted(report, rearm));
}

/// Adds a line for each safety state that begins. The line of a halt describes the last two.
void HapticStatusLog::addStates(const TickReport& report, std::vector<std::string>& lines) {
  const std::uint32_t begun = report.safety_states & ~std::exchange(states_, report.safety_states);
  for (const SafetyState state : {SafetyState::kMovesHand, SafetyState::kLateMachine}) {
    if ((begun & bit(state)) != 0) lines.emplace_back(toText(state));
  }
}

std::string HapticStatusLog::describeStatus(const TickReport& report) {
  if (!report.enabled && !logged_enable_) {
    logged_enable_ = true;
    return "the device's enabling button is not pressed: the client renders force only while you "
           "hold it";
  }
  if (report.lookup != Lookup::kEmpty) empty_since_.reset();
  if (report.lookup == Lookup::kEmpty && !empty_since_) empty_since_ = report.time;
  if (empty_since_ && report.time - *empty_since_ > kPatience && !logged_empty_) {
    logged_empty_ = true;
    return "no frames arrive: there is nothing to touch yet";
  }
  const bool stale = report.lookup == Lookup::kStale;
  const bool fresh = report.lookup == Lookup::kInterpolated;
  if (stale && !stale_) {
    stale_ = true;
    return "no new frames arrive: the force has faded";
  }
  if (fresh && stale_) {
    stale_ = false;
    return "frames arrive again";
  }
  if (!hasActed(report, SafetyAction::kDisarmed))
    deep_since_.reset();
  else if (!deep_since_)
    deep_since_ = report.time;
  if (deep_since_ && report.time - *deep_since_ > kDeepLong && deep_.allow(report.time))
    return "the hand is too deep in the object: no force until it leaves the object";
  if (hasActed(report, SafetyAction::kStiffness) && softer_.allow(report.time))
    return "a wall is softer than the stream asks for: --stiffness-limit or the device limits it";
  if (hasActed(report, SafetyAction::kLatency) && later_.allow(report.time))
    return "the device answers later than its profile declares: walls are softer";
  return "";
}

}  // namespace hapticast::client
