// SPDX-License-Identifier: MIT
// Makes bytes and JPEGs of what vision has found, on a thread of its own, and hands them to the
// sinks: the next frame is looked at meanwhile.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/stream/datagram_signer.hpp"
#include "server/stream/stream_sink.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

class EncoderThread {
 public:
  /// Starts the thread. The sinks and the signer outlive it; without a signer there are no
  /// datagrams. `slices`: how heights are coded.
  explicit EncoderThread(std::vector<StreamSink*> sinks, DatagramSigner* signer = nullptr,
                         SliceSettings slices = {});
  /// Encodes what still waits and ends the thread; a failure that finish() was not asked for is
  /// lost.
  ~EncoderThread();

  /// Hands over a frame of the stream that `description` announces; waits while two are still to be
  /// encoded. Rethrows what encoding has thrown. Thread: the pipeline's.
  void push(StreamDescription description, VisionResult result);
  /// Encodes what still waits, ends the thread and rethrows what encoding has thrown. Thread: the
  /// pipeline's.
  void finish();
  /// Of the last frame that was encoded. Thread: any.
  [[nodiscard]] ReliefBytes reliefBytes() const;

 private:
  struct Job {
    StreamDescription description;
    VisionResult result;
  };
  void run();
  void encode(Job job);
  void stop() noexcept;

  std::vector<StreamSink*> sinks_;
  DatagramSigner* signer_;
  SliceSettings slices_;
  FrameEncoder encoder_;                        // by the thread
  std::optional<StreamDescription> described_;  // by the thread
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;        // under the mutex
  ReliefBytes relief_bytes_;    // under the mutex
  bool ended_ = false;          // under the mutex
  std::exception_ptr failure_;  // under the mutex
  std::thread thread_;          // last: everything above is there when it starts
};

}  // namespace hapticast::server
