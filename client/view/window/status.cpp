// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/status.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace hapticast::client {

namespace {

constexpr Duration kLate{1'500'000};
constexpr Duration kSecond = std::chrono::seconds(1);

std::string haltLine(const TickReport& report) {
  if (report.halt == Halt::kStopped) return "ending: the force goes to zero";
  if (deviceIsBack(report)) return "the device is back: R re-arms the force";
  if (report.halt == Halt::kUnconfirmed) return "a device was found: R gives it the force";
  if (report.halt == Halt::kDeviceLost) return "the device does not answer: no force";
  return "the stream is not trusted any more: no force (R re-arms)";
}

}  // namespace

void TickWatch::add(const TickReport& report) {
  const Duration since = report.time - last_.time;
  if (ticks_++ > 0) {
    if (since > kLate) ++late_;
    second_longest_ = std::max(second_longest_, report.tick_duration);
    second_sum_ += report.tick_duration;
    ++second_ticks_;
  }
  if (report.time - second_begin_ >= kSecond) {
    longest_us_ = toSeconds(second_longest_) * 1e6;
    mean_us_ = toSeconds(second_sum_) * 1e6 /
               static_cast<double>(std::max<std::uint64_t>(second_ticks_, 1));
    second_longest_ = second_sum_ = Duration{0};
    second_ticks_ = 0;
    second_begin_ = report.time;
  }
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    if ((report.interferences >> i & 1U) == 0) continue;
    acted_[i] = report.time;
    ever_[i] = true;
  }
  last_ = report;
}

std::string TickWatch::chain() const {
  std::string words;
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    const char* const what = toText(static_cast<SafetyAction>(i));
    if (*what == '\0' || !ever_[i] || last_.time - acted_[i] > kSecond) continue;
    words.append(words.empty() ? "" : "; ").append(what);
  }
  return words.empty() ? "nothing to do" : words;
}

std::string statusLine(const TickReport& report, const UiState& ui_state) {
  if (report.halt != Halt::kNone) return haltLine(report);
  if (!ui_state.stream.connected) return "no server yet: waiting for one";
  if (!report.enabled) return "the device's button is not held: no force";
  const std::string paused = ui_state.user.paused ? "paused; " : "";
  if (report.lookup == Lookup::kStale) return paused + "no fresh frames: the force has faded";
  if (report.lookup == Lookup::kEmpty) return paused + "waiting for the first frames";
  if (report.contact) return fmt::format("{}in contact, {:.1f} N", paused, report.force_N.norm());
  return paused + (report.over_object ? "over the object" : "nothing touched");
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
