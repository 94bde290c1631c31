// SPDX-License-Identifier: MIT
// Channels of a client's recording. Thread: any.
#pragma once

#include <cstddef>
#include <vector>

#include "common/recording/schemas.hpp"

namespace hapticast::client {

/// Numbers of the channels.
enum RunChannel : std::size_t {
  kSettingsChannel,
  kTickChannel,
  kFrameChannel,
  kPreparedChannel,
  kTimingChannel,
  kControlsChannel,
  kDescriptionChannel,
  kPictureChannel,
  kRunChannels,
};

struct RunChannelName {
  const char* topic;
  const char* message;
  bool is_state = false;  ///< McapChannel::is_state
};
/// Topics and types of the messages, by number.
inline constexpr RunChannelName kRunChannelNames[kRunChannels] = {
    {"/settings", "hapticast.proto.RendererSettings", true},
    {"/tick", "hapticast.proto.Ticks"},
    {"/received", "hapticast.proto.ReceivedFrame"},
    {"/prepared", "hapticast.proto.PreparedFrame"},
    {"/timing", "hapticast.proto.Timing", true},
    {"/controls", "hapticast.proto.UserControls", true},
    {"/description", "hapticast.proto.StreamDescription", true},
    {"/picture", "foxglove.CompressedImage"},
};

/// Ticks in one message.
inline constexpr std::size_t kTicksPerMessage = 10;

/// Returns the channels of a recording, by number.
[[nodiscard]] inline std::vector<McapChannel> listRunChannels() {
  std::vector<McapChannel> channels;
  channels.reserve(kRunChannels);
  for (const RunChannelName& each : kRunChannelNames)
    channels.push_back(makeChannel(each.topic, each.message, each.is_state));
  return channels;
}

}  // namespace hapticast::client
