// SPDX-License-Identifier: MIT
// Channels of a client's recording. Thread: any.
#pragma once

#include <cstddef>

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
};
/// Topics and types of the messages, by number.
inline constexpr RunChannelName kRunChannelNames[kRunChannels] = {
    {"/settings", "hapticast.proto.RendererSettings"},
    {"/tick", "hapticast.proto.Ticks"},
    {"/received", "hapticast.proto.ReceivedFrame"},
    {"/prepared", "hapticast.proto.PreparedFrame"},
    {"/timing", "hapticast.proto.Timing"},
    {"/controls", "hapticast.proto.UserControls"},
    {"/description", "hapticast.proto.StreamDescription"},
    {"/picture", "foxglove.CompressedImage"},
};

}  // namespace hapticast::client
