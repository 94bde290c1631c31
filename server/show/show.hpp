// SPDX-License-Identifier: MIT
// A show: one stream from its start to its end. It owns the sinks, waits for viewers and for the
// time of each frame, carries out the requests of operators, and ends at signals. A Producer makes
// the stream.
// Thread: the one of run(), if a function states no other.
#pragma once

#include <atomic>
#include <optional>

#include "common/time.hpp"
#include "server/pipeline/operator_requests.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"
#include "server/show/reload.hpp"
#include "server/show/sinks.hpp"

namespace hapticast::server {

/// One stream with its producer and its sinks.
class Show {
 public:
  /// Time for viewers to play the end of a stream before the goodbye.
  static constexpr Duration kPlayout = std::chrono::milliseconds(500);
  /// Interval in which waiting code checks for the end and for requests; chosen.
  static constexpr Duration kSlice = std::chrono::milliseconds(20);
  /// What ends a wait early, besides stop().
  enum class Until : std::uint8_t { kDue, kDueOrRequest };

  /// Opens the ports and the files of `settings`. `reread`: reads the settings again at SIGHUP;
  /// null: SIGHUP changes nothing. The other arguments must outlive this object. Throws
  /// AddressError, KeyFileError, RecordingError or std::runtime_error, each with one line.
  Show(const Settings& settings, const Clock& clock, ReadSettings reread, Producer& producer);
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;

  /// Streams until the end of the stream, until a signal, or until stop(). Returns whether the
  /// stream is complete (Producer::finish()). Throws what the producer throws. Call it once.
  bool run();
  /// Ends run() soon. Thread: any.
  void stop() noexcept { stop_ = true; }
  /// Returns whether streaming has begun. A later SourceError of run() is not due to wrong input of
  /// the user.
  [[nodiscard]] bool streaming() const { return streaming_; }

  /// For the producer. Returns whether the show ends.
  [[nodiscard]] bool stopped() const { return stop_ || (signalled_ != nullptr && *signalled_); }
  /// For a producer with a media clock. Waits until `due`. Returns false if the show ends, or a
  /// request of an operator ends the wait.
  bool waitUntil(MediaTime due, Until until = Until::kDue);
  /// For a producer with a media clock. Returns the sinks.
  [[nodiscard]] Sinks& sinks() { return *sinks_; }
  /// For the producer. Returns the statistics of the stream.
  [[nodiscard]] PipelineCounter& counter() { return counter_; }

 private:
  /// Starts the network thread, or reacts to signals without one.
  void listen();
  void waitForViewer();
  void play();
  /// Carries out the requests of operators. Returns whether the stream is paused.
  bool operate();

  const Settings& settings_;
  Producer& producer_;
  std::atomic<bool> stop_{false};
  const std::atomic<bool>* signalled_ = nullptr;  // without viewers; else the service has signals
  Reloader reloader_;                             // used by the network thread only
  OperatorRequests requests_;
  PipelineCounter counter_;
  std::optional<Sinks> sinks_;  // after what its port for operators reads
  bool streaming_ = false;
};

}  // namespace hapticast::server
