// SPDX-License-Identifier: MIT
// The part of a server that passes on a stream of its own: it signs the frames, serves viewers, and
// publishes to edges (--publish) and to a recording (--record). A pipeline or a recording makes the
// stream. Thread: see each function.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "server/recording/stream_recorder.hpp"
#include "server/relay/relay_publisher.hpp"
#include "server/show/stream_service.hpp"

namespace hapticast::server {

/// Time for viewers to play the end of a stream before the goodbye.
inline constexpr Duration kPlayout = std::chrono::milliseconds(500);
/// Interval in which waiting code checks for the end and for requests; chosen.
inline constexpr Duration kSlice = std::chrono::milliseconds(20);

/// Signer, viewers, edges and recording of one stream.
class Origin {
 public:
  /// Opens the ports and the files of `settings`. Throws AddressError, KeyFileError or
  /// std::runtime_error, each with one line. All arguments but `description` must outlive this
  /// object.
  Origin(const Settings& settings, const Clock& clock, const MediaClock& media_clock,
         const StreamDescription& description);

  /// Starts the threads as StreamService::start() does. `on_control` receives the requests of
  /// operators; thread: the network's. Then the figures for --http are those of this object and of
  /// `add_metrics`; thread: the network's. Call it once. Thread: the owner's.
  void start(std::function<void()> on_signal, std::function<void()> on_reload,
             Broadcaster::OnControl on_control, std::function<void(Metrics&)> add_metrics);

  [[nodiscard]] FrameSigner& signer() { return signer_; }
  [[nodiscard]] StreamService& service() { return service_; }
  /// Returns all receivers of the stream.
  [[nodiscard]] std::vector<StreamSink*> sinks();
  /// Returns the recorder; null: there is none.
  [[nodiscard]] StreamRecorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }

 private:
  FrameSigner signer_;  // outlives all encoded frames
  std::optional<RelayPublisher> relay_;
  std::optional<StreamRecorder> recorder_;
  StreamService service_;  // after what its port for operators reads
};

}  // namespace hapticast::server
