// SPDX-License-Identifier: MIT
// Changes to a running stream that wait for the pipeline. Operators pause, seek and set the
// material (ControlQueue). A reload of the settings changes materials too. The network thread adds
// the changes, and the pipeline's thread applies them between two frames. Thread: see each
// function.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "common/protocol/messages.hpp"
#include "server/pipeline/control_queue.hpp"
#include "server/pipeline/operated_stream.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/stream/limited_log.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Requests that wait for the pipeline.
class OperatorRequests {
 public:
  /// Time in which newer seeks end a running one, from the begin of the first. The seek that runs
  /// then comes to its end. So an operator who seeks on and on cannot stop the stream; chosen.
  static constexpr Duration kNewerSeeks = std::chrono::seconds(1);

  /// `clock` must outlive this object.
  explicit OperatorRequests(const Clock& clock) : clock_(clock), log_(clock) {}

  /// Adds a request of an operator. carryOut() calls `confirm` once the request is carried out, or
  /// newer values have replaced all of its own. Thread: any.
  void push(const Control& request, std::function<void()> confirm) {
    queue_.push(request, std::move(confirm));
  }
  /// Stores the settings that a reload has read. The next carryOut() applies their materials and
  /// masses only. Thread: any.
  void pushReload(VisionSettings reloaded);
  /// Carries out the requests and the reload that were added since the last call. A newer seek ends
  /// a running one. Throws SourceError if the source fails during a seek. Thread: the stream's.
  void carryOut(OperatedStream& stream, PipelineCounter& counter);
  /// Returns whether a request of an operator waits. Thread: any.
  [[nodiscard]] bool waits() const { return queue_.waits(); }
  /// Returns whether the stream is paused. Thread: the stream's.
  [[nodiscard]] bool paused() const { return paused_; }

 private:
  void applyReload(OperatedStream& stream);
  void carryOut(const Control& request, OperatedStream& stream, PipelineCounter& counter);
  void seek(double time_s, OperatedStream& stream, PipelineCounter& counter);

  const Clock& clock_;
  ControlQueue queue_;
  std::mutex mutex_;
  std::optional<VisionSettings> reloaded_;  // guarded by mutex_
  bool paused_ = false;
  LimitedLog log_;
};

}  // namespace hapticast::server
