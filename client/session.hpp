// SPDX-License-Identifier: MIT
// The session with one server: finds and dials the server, receives and decodes its stream, and
// logs what happens to the connection. The network thread and the decode thread live here. The
// thread of start() calls every function, except where another thread is named.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/report/summary.hpp"
#include "client/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class Session {
 public:
  struct Events {
    std::function<void(const VideoFrame&, const Workspace&)> picture;  ///< thread: network
    std::function<void(const PlayableReliefs&)> frame;                 ///< thread: network
    std::function<void()> ended;  ///< a signal, or a server that cannot be used; thread: network
  };

  /// Fills `pool` and `stream`, which outlive the session. `wants_video`: whether any view shows
  /// pictures.
  Session(const Settings& settings, const Clock& clock, FramePool& pool,
          LatestValue<StreamTiming>& stream, bool wants_video, Events events);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void start();
  void stop();
  /// Returns the newest statistics. Thread: one.
  [[nodiscard]] const ConnectionStats& stats();
  /// Tells the server whether the hand is in contact.
  void setInContact(bool contact);
  /// Returns the text to log, when no server was named, none answers, and the list of those on the
  /// LAN has changed.
  std::optional<std::string> listServers(LocalTime now);
  /// Returns HOST:PORT, or mdns:NAME.
  [[nodiscard]] std::string serverName() const;
  /// Returns whether the server cannot be used. Thread: any.
  [[nodiscard]] bool failed() const;
  /// Returns why no server was ever connected; nothing if one was. After stop().
  [[nodiscard]] std::optional<std::string> neverConnected() const;
  /// Sets what the session counted. After stop().
  void addTo(RunResult& result) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::client
