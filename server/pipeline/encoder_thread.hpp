// SPDX-License-Identifier: MIT
// Encodes frames and pictures on a separate thread and passes them to the sinks. Meanwhile vision
// processes the next frame. Thread: see each function.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/pipeline/pipeline_counts.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/stream_sink.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// The encoder's thread, with the queue of frames that wait for it.
class EncoderThread {
 public:
  /// Starts the thread. The sinks and `signer` must outlive this object. If `signer` is null,
  /// frames are not signed, and no datagrams are made. `slices`: settings of the height codec.
  /// `clock` measures times() and must outlive this object; null: no measurement.
  explicit EncoderThread(std::vector<StreamSink*> sinks, FrameSigner* signer = nullptr,
                         SliceSettings slices = {}, const Clock* clock = nullptr);
  /// Encodes the frames that wait, and ends the thread. After an exception of the encoder it drops
  /// them. Discards an exception that push() or finish() has not rethrown. Thread: the pipeline's.
  ~EncoderThread();

  /// Adds the frame `result` to the queue. `description`: the stream to which the frame belongs.
  /// Blocks while two frames wait in the queue. Rethrows an exception that the encoder has thrown.
  /// Thread: the pipeline's.
  void push(StreamDescription description, VisionResult result);
  /// Replaces the settings of the height codec, from the next encoded frame on. Thread: any.
  void setSlices(const SliceSettings& slices);
  /// Encodes the frames that wait, and ends the thread. Then rethrows an exception that the encoder
  /// has thrown. Thread: the pipeline's.
  void finish();
  /// Returns the sizes of the reliefs in the last encoded frame, by object id. Thread: any.
  [[nodiscard]] ReliefBytes reliefBytes() const;
  /// Returns the times of all frames and pictures. Thread: any.
  [[nodiscard]] EncoderTimes times() const;

 private:
  struct Job {
    StreamDescription description;
    VisionResult result;
  };
  void run();
  void encode(Job job, const SliceSettings& slices);
  void encodeVideoOf(const Job& job);
  [[nodiscard]] LocalTime now() const { return clock_ != nullptr ? clock_->now() : LocalTime(); }
  void stop() noexcept;

  std::vector<StreamSink*> sinks_;
  FrameSigner* signer_;
  const Clock* clock_;
  FrameEncoder encoder_;                        // used by the thread only
  std::optional<StreamDescription> described_;  // used by the thread only
  mutable std::mutex mutex_;
  SliceSettings slices_;  // guarded by mutex_
  std::condition_variable changed_;
  std::deque<Job> jobs_;        // guarded by mutex_
  ReliefBytes relief_bytes_;    // guarded by mutex_
  EncoderTimes times_;          // guarded by mutex_
  bool ended_ = false;          // guarded by mutex_
  std::exception_ptr failure_;  // guarded by mutex_
  std::thread thread_;          // last member: it uses all others
};

/// Returns the largest error of heights on the wire, mm, that changes the force by at most the
/// error budget of `vision`. With the default budget and the usual stiffness it is
/// kDefaultHeightError_mm.
[[nodiscard]] double computeHeightError_mm(const VisionSettings& vision);

}  // namespace hapticast::server
