// SPDX-License-Identifier: MIT
// Where a stream goes once it is bytes: to viewers, and to whatever else takes it (a recorder, a
// relay). A further sink is one more class of this kind.
#pragma once

#include "common/haptic_frame.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Everything is called by one thread, the encoder's; a sink hands over and does not wait.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// What follows belongs to this stream. Comes before the first frame and at every change.
  virtual void describe(const StreamDescription& description) = 0;
  virtual void publish(EncodedFrame frame) = 0;
  virtual void publish(EncodedVideo video) = 0;
  /// Whether encoding pictures is worth it.
  [[nodiscard]] virtual bool videoWanted() const = 0;
  /// Whether signing datagrams of frames is worth it.
  [[nodiscard]] virtual bool datagramsWanted() const = 0;
};

}  // namespace hapticast::server
