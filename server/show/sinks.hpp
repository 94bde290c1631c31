// SPDX-License-Identifier: MIT
// The sinks of one show: viewers, edges (--publish), a recording and watchers (--record, --live),
// and the signer of its frames. An edge passes on the frames of an origin, so it has viewers only
// and signs nothing. Thread: see each function.
#pragma once

#include <optional>
#include <vector>

#include "server/recording/stream_recorder.hpp"
#include "server/relay/relay_publisher.hpp"
#include "server/show/stream_service.hpp"

namespace hapticast::server {

/// Signer, viewers, edges and recording of one stream.
class Sinks {
 public:
  /// Opens the ports and the files of `settings`. Throws AddressError, KeyFileError or
  /// std::runtime_error, each with one line. All arguments but `description` must outlive this
  /// object.
  Sinks(const Settings& settings, const Clock& clock, const MediaClock& media_clock,
        const StreamDescription& description);

  [[nodiscard]] FrameSigner& signer() { return signer_; }
  [[nodiscard]] StreamService& service() { return service_; }
  /// Returns all receivers of the stream.
  [[nodiscard]] std::vector<StreamSink*> all();
  /// Returns the state of the origin; nullopt without --publish. Thread: any.
  [[nodiscard]] std::optional<RelayCounts> relayCounts() const;
  /// Returns the recorder; null: there is none.
  [[nodiscard]] StreamRecorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }

 private:
  FrameSigner signer_;  // outlives all encoded frames
  std::optional<RelayPublisher> relay_;
  std::optional<StreamRecorder> recorder_;
  StreamService service_;  // after what its port for operators reads
};

}  // namespace hapticast::server
