// SPDX-License-Identifier: MIT
// A stream drawn at random, as messages of the wire with the times of their arrival: one or two
// bodies that move, with losses, jitter, a second welcome, cuts, impacts and materials.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "client/haptics/tick_report.hpp"
#include "common/codec/coded_frame.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::testing {

/// A message as it arrived, on the viewer's clock.
struct ArrivedMessage {
  LocalTime arrival;
  std::vector<std::uint8_t> bytes;
};

/// Returns where a hand goes that presses on the nearest object, device mm. `last` is the report of
/// the tick before.
inline Vec3 chooseHand(const client::TickReport& last, double time_s) {
  const Vec2 over_mm = last.object_present ? last.object_centre_mm : Vec2(0.0, 0.0);
  return last.mapping.toDevice(
      {over_mm.x() + std::sin(3.1 * time_s), over_mm.y(), 22.0 + 8.0 * std::cos(5.0 * time_s)});
}

class DrawnStream {
 public:
  explicit DrawnStream(std::uint64_t seed) : random_(seed) {
    description_.name = "drawn";
    description_.fps = draw(15.0, 60.0);
    description_.workspace.width_px = static_cast<int>(draw(160.0, 640.0));
    description_.workspace.height_px = static_cast<int>(draw(120.0, 480.0));
    description_.pipeline_latency = fromSeconds(draw(0.0, 0.1));
    offset_ = fromSeconds(draw(-100.0, 100.0));
  }

  /// Returns the messages of `seconds` from `begin` on, in the order of their arrival.
  std::vector<ArrivedMessage> draw(LocalTime begin, double seconds) {
    welcome(begin);
    const auto frames = static_cast<int>(seconds * description_.fps);
    for (int i = 0; i < frames; ++i) addFrame(begin + fromSeconds(i / description_.fps));
    if (draw(0.0, 1.0) < 0.3) welcome(begin + fromSeconds(0.6 * seconds));
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
    return messages_;
  }

 private:
  double draw(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }
  [[nodiscard]] MediaTime media(LocalTime at) const {
    return MediaTime(at.time_since_epoch() + offset_);
  }

  /// A welcome, and the pongs that measure the clock.
  void welcome(LocalTime at) {
    Welcome welcome;
    welcome.description = description_;
    messages_.push_back({at, encode(welcome)});
    for (int i = 0; i < 8; ++i) {
      const LocalTime sent = at + std::chrono::milliseconds(20 * i);
      const Duration there = fromSeconds(draw(1e-4, 3e-3)), back = fromSeconds(draw(1e-4, 3e-3));
      const MediaTime read = media(sent + there);
      messages_.push_back({sent + there + back, encode(Pong{sent, read, read})});
    }
  }

  HapticObject body(std::uint32_t id, double time_s) {
    const Workspace& workspace = description_.workspace;
    const double rate = 4.0 + id;
    HapticObject to;
    to.id = id;
    to.motion.position_mm = {20.0 * std::sin(rate * time_s), 5.0 * id, 12.0};
    to.motion.velocity_mm_s = {20.0 * rate * std::cos(rate * time_s), 0.0, 0.0};
    to.motion.acceleration_mm_s2 = {-20.0 * rate * rate * std::sin(rate * time_s), 0.0, 0.0};
    if (draw(0.0, 1.0) < 0.1)
      to.impacts.push_back({mediaTime(time_s), Vec3(0.0, 0.0, draw(-300.0, 300.0))});
    if (id == 2) to.material.stiffness_N_mm = 0.3;
    const Vec2 px = workspace.toImage(to.motion.position_mm.head<2>());
    const int half = workspace.height_px / 6;
    const PixelRect rect{
        std::clamp(static_cast<int>(px.x()) - half, 0, workspace.width_px - 2 * half),
        std::clamp(static_cast<int>(px.y()) - half, 0, workspace.height_px - 2 * half), 2 * half,
        2 * half};
    auto relief = std::make_shared<Relief>(Relief::blank(rect));
    for (int v = 0; v < rect.height; ++v) {
      for (int u = 0; u < rect.width; ++u) {
        const double r = std::hypot(u - half + 0.5, v - half + 0.5) / half;
        if (r >= 0.95) continue;
        const auto i = static_cast<std::size_t>(v * rect.width + u);
        relief->mask[i] = 1;
        relief->height_mm[i] = static_cast<float>(5.0 + 15.0 * std::sqrt(1.0 - r * r));
      }
    }
    to.relief = std::move(relief);
    return to;
  }

  void addFrame(LocalTime captured) {
    HapticFrame frame;
    if (draw(0.0, 1.0) < 0.02) ++epoch_;
    frame.epoch = epoch_;
    frame.id = ++id_;
    frame.media_time = media(captured);
    const double time_s = toSeconds(captured);
    frame.objects.push_back(body(1, time_s));
    if (id_ % 40 < 20) frame.objects.push_back(body(2, time_s));
    for (HapticObject& object : frame.objects) object.changed_in_frame = frame.id;
    const auto bytes = encode(coder_.code(frame));
    if (draw(0.0, 1.0) < 0.05) return;  // lost
    const double jitter_s = draw(0.0, 1.0) < 0.1 ? draw(0.0, 0.12) : draw(0.0, 0.01);
    const LocalTime at = captured + description_.pipeline_latency + fromSeconds(jitter_s);
    messages_.push_back({at, bytes});
    if (draw(0.0, 1.0) < 0.03) messages_.push_back({at + fromSeconds(0.01), bytes});  // twice
  }

  std::mt19937_64 random_;
  StreamDescription description_;
  Duration offset_{};
  FrameCoder coder_;
  std::uint32_t epoch_ = 1;
  std::uint64_t id_ = 0;
  std::vector<ArrivedMessage> messages_;
};

}  // namespace hapticast::testing
