// SPDX-License-Identifier: MIT
// Consumer interface of the encoded stream: viewers today, for example a recorder or a relay later.
// A further sink implements this interface. Thread: the encoder's.
#pragma once

#include "common/haptic_frame.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Called by one thread, the encoder's. Implementations must not block.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// Announces the stream of the items that follow. Called before the first frame and at every
  /// change.
  virtual void describe(const StreamDescription& description) = 0;
  /// Receives the next frame.
  virtual void publish(EncodedFrame frame) = 0;
  /// Receives the next picture.
  virtual void publish(EncodedVideo video) = 0;
  /// Returns whether pictures are worth their encoding.
  [[nodiscard]] virtual bool videoWanted() const = 0;
  /// Returns whether datagrams are worth their signing.
  [[nodiscard]] virtual bool datagramsWanted() const = 0;
};

}  // namespace hapticast::server
