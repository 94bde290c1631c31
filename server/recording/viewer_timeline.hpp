// SPDX-License-Identifier: MIT
// Sends the playback of a recording to one viewer (--on-demand), which may pause, seek, and set the
// speed (TimelinePlayer). A flood of requests costs one seek in kSeekPause. Thread: the network's.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "common/playback/timeline_player.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/frame_signer.hpp"
#include "server/stream/session.hpp"

namespace hapticast::server {

/// The stream of one viewer.
class ViewerTimeline : public std::enable_shared_from_this<ViewerTimeline> {
 public:
  /// Least time between two seeks. Chosen: a seek reads a chunk of the file (about 1 ms).
  static constexpr Duration kSeekPause = std::chrono::milliseconds(20);

  /// What all viewers share; it must outlive the timeline.
  struct Server {
    asio::io_context& io;
    const MediaClock& media_clock;
    FrameSigner& signer;
    std::string name;  ///< of the stream; empty: as recorded
  };

  ViewerTimeline(const Server& server, RecordingPlayer player,
                 const std::shared_ptr<Session>& viewer);

  /// Plays until stop() or until the viewer is gone.
  asio::awaitable<void> play();
  /// Requests a pause, a place or a speed.
  void request(const Control& control);
  /// Ends play().
  void stop();

 private:
  /// Waits for `time`, or until stop(). `for_requests`: or until a request.
  asio::awaitable<void> waitFor(Duration time, bool for_requests);
  /// Sends a prepared item to the viewer.
  void publish(Session& viewer, RecordedItem item);
  /// Sends the description, if it changed.
  void describe(Session& viewer);

  const Server& server_;
  TimelinePlayer player_;
  std::weak_ptr<Session> viewer_;
  asio::steady_timer timer_;
  FrameEncoder encoder_;
  Control request_;
  bool stopped_ = false, waits_for_requests_ = false;
};

/// The time lines of all viewers.
class ViewerTimelines final : public ViewerStreams {
 public:
  /// `recording` must outlive this object. `loop`: each time line starts again at its end.
  ViewerTimelines(ViewerTimeline::Server server, const StreamReader& recording, bool loop)
      : server_(std::move(server)), recording_(recording), loop_(loop) {}

  void onJoined(const std::shared_ptr<Session>& viewer) override;
  void onLeft(const Session& viewer) override;
  void onControl(const Session& viewer, const Control& control) override;

 private:
  const ViewerTimeline::Server server_;
  const StreamReader& recording_;
  const bool loop_;
  std::map<const Session*, std::shared_ptr<ViewerTimeline>> timelines_;
};

}  // namespace hapticast::server
