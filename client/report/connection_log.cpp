// SPDX-License-Identifier: MIT
#include "client/report/connection_log.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hapticast::client {

std::string greeting(const StreamDescription& stream, Method method) {
  std::string text = fmt::format("connected: {}, {} x {}, {:g} frames/s", stream.name,
                                 stream.workspace.width_px, stream.workspace.height_px, stream.fps);
  if (method == Method::kThesis && stream.method != Method::kThesis) {
    text +=
        "; --method thesis here, but not on the server: segmentation, smoothing, motion and "
        "workspace stay its own";
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
  return limit_.admit("the server looks through its clip first: " +
                          std::to_string(std::lround(100.0 * share)) + " % done",
                      now);
}

std::optional<std::string> ConnectionLog::lost(const std::string& why, LocalTime now) {
  if (why == reason_ && !lost_interval_.isDue(now)) return std::nullopt;
  reason_ = why;
  lost_interval_.onLogged(now);
  return limit_.admit(ever_connected_ ? server_ + ": " + why + "; trying again"
                                      : "waiting for a server at " + server_ + " (" + why + ")",
                      now);
}

std::optional<std::string> StreamErrorLog::onCounts(const ReceiverCounts& counts, LocalTime now) {
  if (!interval_.isDue(now)) return std::nullopt;
  std::string text;
  const auto add = [&](std::uint64_t count, std::uint64_t logged, const char* what) {
    if (count > logged)
      text += (text.empty() ? "" : "; ") + (what + std::to_string(count - logged));
  };
  add(counts.reliefs_rejected, logged_.reliefs_rejected,
      "reliefs outside the announced picture or too high, whose objects are not shown: ");
  add(counts.slices_refused, logged_.slices_refused, "slices of heights that cannot be decoded: ");
  add(counts.resyncs, logged_.resyncs, "jumps of the frames' ids, after which touch begins anew: ");
  add(counts.reliefs_missing, logged_.reliefs_missing,
      "objects without a shape, which are not shown: ");
  add(counts.overrun + counts.no_slot, logged_.overrun + logged_.no_slot,
      "frames that came faster than they can be felt and were dropped: ");
  if (text.empty()) return std::nullopt;
  logged_ = counts;
  interval_.onLogged(now);
  return "server error: " + text;
}

}  // namespace hapticast::client
