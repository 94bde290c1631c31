// SPDX-License-Identifier: MIT
#include "client/view/status.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

constexpr Duration kActed = std::chrono::seconds(1);
constexpr double kLeastForce_N = 0.02;  // chosen: no hand feels less

/// Returns `value` with one digit after the point.
std::string toTenths(double value) {
  const long tenths = std::lround(10.0 * std::abs(value));
  return (value < 0.0 && tenths > 0 ? "-" : "") + std::to_string(tenths / 10) + "." +
         std::to_string(tenths % 10);
}

std::string haltLine(const TickReport& report) {
  switch (report.halt) {
    case Halt::kStopped:
      return "the client ends: the force fades to zero";
    case Halt::kUnconfirmed:
      return "no force: the client detected this device by itself; press R to confirm it";
    case Halt::kDeviceLost:
      return deviceIsBack(report)
                 ? "no force: the device answers again; press R to re-arm the force"
                 : "no force: the device does not answer; check its cable and its power";
    default:
      return "no force: the client does not trust the stream; press R to re-arm the force";
  }
}

/// Returns reason and remedy if the forces are switched off, else an empty text.
std::string offLine(const TickReport& report, const UserControls& user) {
  if (user.force_factor <= 0.0)
    return "the share of the force is 0; raise \"force x\" in the panel";
  if (!user.static_on && !user.dynamic_on) return "both forces are off; press S and D";
  if (!user.static_on && report.dynamic_force_N.norm() < kLeastForce_N)
    return "the static force is off; press S";
  return {};
}

std::string contactLine(const TickReport& report, const UserControls& user) {
  const double force_N = report.force_N.norm();
  if (force_N >= kLeastForce_N) return "in contact, " + toTenths(force_N) + " N";
  const auto acts = [&report](SafetyAction action) {
    return (report.safety_actions & bit(action)) != 0;
  };
  std::string why = offLine(report, user);
  if (!why.empty()) return "in contact, no force: " + why;
  if (acts(SafetyAction::kDisarmed)) {
    why = "the tip is too deep; lift the tip out of the object";
  } else if (acts(SafetyAction::kNotFinite)) {
    why = "the stream has an invalid number; lift the tip, or wait";
  } else if (acts(SafetyAction::kFade)) {
    why = "the force fades in; wait";
  } else if (acts(SafetyAction::kTank)) {
    why = "the energy limit is reached; lift the tip, then press again";
  } else {
    why = "the touch is too light; press deeper";
  }
  return "in contact, no force: " + why;
}

std::string approachLine(const TickReport& report) {
  const auto gap_mm = surfaceGap_mm(report);
  if (!gap_mm)
    return report.object_present ? "beside the object: move the tip over it"
                                 : "nothing to touch in this picture: wait for an object";
  if (*gap_mm < 0.0)
    return toTenths(-*gap_mm) + " mm below the surface: lift the tip out of the object";
  return "over the object, " + toTenths(*gap_mm) + " mm above its surface";
}

}  // namespace

void TickStatus::add(const TickReport& report) {
  const Duration since = report.time - last_.time;
  if (ticks_++ > 0) {
    if (since > kLateTick) ++late_;
    second_longest_ = std::max(second_longest_, report.tick_duration);
    second_sum_ += report.tick_duration;
    ++second_ticks_;
  }
  if (report.time - second_begin_ >= kActed) {
    longest_us_ = toSeconds(second_longest_) * 1e6;
    mean_us_ = toSeconds(second_sum_) * 1e6 /
               static_cast<double>(std::max<std::uint64_t>(second_ticks_, 1));
    second_longest_ = second_sum_ = Duration{0};
    second_ticks_ = 0;
    second_begin_ = report.time;
  }
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    if ((report.safety_actions >> i & 1U) == 0) continue;
    acted_[i] = report.time;
    ever_[i] = true;
  }
  has_touched_ = has_touched_ || (report.contact && report.force_N.norm() >= kLeastForce_N);
  last_ = report;
}

std::string TickStatus::chain() const {
  std::string words;
  for (std::size_t i = 0; i < acted_.size(); ++i) {
    const char* const what = toText(static_cast<SafetyAction>(i));
    if (*what == '\0' || !ever_[i] || last_.time - acted_[i] > kActed) continue;
    words.append(words.empty() ? "" : "; ").append(what);
  }
  return words.empty() ? "no action" : words;
}

std::optional<double> surfaceGap_mm(const TickReport& report) {
  if (!report.object_present || !report.over_object) return std::nullopt;
  return report.hip_mm.z() - report.height_at_hip_mm;
}

std::string touchLine(const TickReport& report, const UserControls& user) {
  if (report.halt != Halt::kNone) return haltLine(report);
  return report.contact ? contactLine(report, user) : approachLine(report);
}

std::string statusLine(const TickReport& report, const UiState& ui_state) {
  if (report.halt != Halt::kNone) return haltLine(report);
  if (!ui_state.request.empty()) return "no force: the client has not checked the device yet";
  const ConnectionStats& stream = ui_state.stream;
  if (!stream.connected) return "no force: no server answers; the client waits and connects again";
  if (!report.enabled) return "no force: the device's button is not held; hold it";
  const std::string paused = ui_state.user.paused ? "paused; " : "";
  if (report.lookup == Lookup::kEmpty) {
    if (!stream.isScanning()) return paused + "waiting for the first frames";
    return paused +
           "the server scans its clip: " + std::to_string(std::lround(100.0 * stream.scan_share)) +
           " % done";
  }
  if (report.lookup == Lookup::kStale)
    return paused + "no force: no fresh frames arrive; wait, or check the server and the network";
  return paused + touchLine(report, ui_state.user);
}

std::string stateLines(const TickReport& report, const ConnectionStats& stream) {
  std::string lines;
  for (const SafetyState state :
       {SafetyState::kMovesHand, SafetyState::kTrustLost, SafetyState::kLateMachine}) {
    if ((report.safety_states & bit(state)) == 0) continue;
    const bool latched = state != SafetyState::kLateMachine;
    if (!lines.empty()) lines += '\n';
    lines += toText(state);
    if (latched) lines += " (press R when you have read this)";
  }
  if (stream.connected && stream.picture_reduced)
    lines += (lines.empty() ? "" : "\n") + std::string("picture reduced: the link is slow");
  return lines;
}

std::string hintLine(const TickStatus& ticks, const UiState& ui_state) {
  if (!ui_state.request.empty()) return ui_state.request;
  const TickReport& report = ticks.last();
  if (ticks.hasTouched() || report.halt != Halt::kNone) return {};
  if (!ui_state.stream.connected) return "The client connects as soon as the server answers.";
  if (!report.enabled) return {};
  if (report.lookup == Lookup::kEmpty) {
    return ui_state.stream.isScanning() ? "The picture appears at the end of the scan."
                                        : "The picture appears with the first frames.";
  }
  return ui_state.pointer_is_device
             ? "Move over the object, turn the wheel down to press. F1: keys and colours."
             : "Touch the object with the device. F1: keys and colours.";
}

}  // namespace hapticast::client
