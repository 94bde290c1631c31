// SPDX-License-Identifier: MIT
// Messages of a client's recording (proto/recording.proto) as bytes and back. The decoders check
// their bytes: a result is complete, and its numbers are within the limits of the wire, except for
// those of ticks, which a renderer checks itself. Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "client/haptics/playback/playout.hpp"
#include "client/haptics/renderer.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/net/frame_preparer.hpp"
#include "common/result.hpp"

namespace hapticast::client {

using RecordedBytes = std::vector<std::uint8_t>;

/// A StreamTiming, and whether the decode thread was reset before it.
struct RecordedTiming {
  StreamTiming timing;
  bool resets_reliefs = false;
};

/// The result of the decode thread for one frame.
struct RecordedPreparation {
  std::uint64_t id = 0;
  bool handed_over = false;
};

[[nodiscard]] RecordedBytes encodeTicks(std::span<const TickReport> ticks);
[[nodiscard]] RecordedBytes encodeFrame(const AssembledFrame& assembled);
[[nodiscard]] RecordedBytes encodePreparation(const RecordedPreparation& preparation);
[[nodiscard]] RecordedBytes encodeTiming(const RecordedTiming& timing);
[[nodiscard]] RecordedBytes encodeControls(const UserControls& controls);
[[nodiscard]] RecordedBytes encodeSettings(const RendererSettings& settings);

/// Decode the bytes. Of a tick's report they return time, inputs, forces and the members that the
/// message has; the others have their defaults.
[[nodiscard]] Result<std::vector<TickReport>> decodeTicks(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<AssembledFrame> decodeReceivedFrame(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<RecordedPreparation> decodePreparation(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<RecordedTiming> decodeTiming(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<UserControls> decodeControls(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<RendererSettings> decodeSettings(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::client
