// SPDX-License-Identifier: MIT
// Interface of a consumer of the encoded stream. The viewers' broadcaster is one. The recorder and
// the relay's publisher are others. Thread: the encoder's.
#pragma once

#include <algorithm>
#include <vector>

#include "common/haptic_frame.hpp"
#include "common/protocol/messages.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/frame_signer.hpp"

namespace hapticast::server {

/// Receives the items of a stream, in order. Only the encoder's thread calls it. Implementations
/// must not block.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// Receives the description of the stream to which the next items belong. It is called before the
  /// first frame and at every change.
  virtual void describe(const StreamDescription& description) = 0;
  /// Receives a new key of the sealed datagrams. It is called before the first frame whose
  /// datagrams this key seals.
  virtual void changeKey(const DatagramKey& key) = 0;
  /// Receives the next frame of the stream.
  virtual void publish(EncodedFrame frame) = 0;
  /// Receives the next picture.
  virtual void publish(EncodedVideo video) = 0;
  /// Returns whether the sink needs pictures. If no sink does, they are not encoded.
  [[nodiscard]] virtual bool videoWanted() const = 0;
  /// Returns whether the sink needs datagrams. If no sink does, they are not signed.
  [[nodiscard]] virtual bool datagramsWanted() const = 0;
};

/// Passes a new key of the sealed datagrams to `sinks`, if one is due. Call it before each frame.
inline void rotateKey(FrameSigner& signer, const std::vector<StreamSink*>& sinks) {
  const auto key = signer.rotateKey();
  if (!key) return;
  for (StreamSink* const sink : sinks) sink->changeKey(*key);
}

/// Return whether at least one of `sinks` needs pictures, or datagrams.
[[nodiscard]] inline bool isVideoWanted(const std::vector<StreamSink*>& sinks) {
  return std::any_of(sinks.begin(), sinks.end(), [](auto* sink) { return sink->videoWanted(); });
}
[[nodiscard]] inline bool areDatagramsWanted(const std::vector<StreamSink*>& sinks) {
  return std::any_of(sinks.begin(), sinks.end(),
                     [](auto* sink) { return sink->datagramsWanted(); });
}

}  // namespace hapticast::server
