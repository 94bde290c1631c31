// SPDX-License-Identifier: MIT
// Serves one stream to viewers: the network thread with listener, broadcaster, datagrams,
// announcement and signals. The producer of the stream (vision, or an edge's subscription) passes
// it to the broadcaster. Thread: the caller's, except where a function says "any".
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "server/http/http_server.hpp"
#include "server/page/page_responder.hpp"
#include "server/settings/settings.hpp"
#include "server/show/service_manager.hpp"
#include "server/stream/announce.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/limited_log.hpp"
#include "server/stream/listener.hpp"
#include "server/stream/multicast_group.hpp"

namespace hapticast::server {

/// The part of a server that serves viewers.
class StreamService {
 public:
  /// Least time between two reloads. Signals meanwhile are one reload. Chosen: reading the files
  /// takes milliseconds of the network thread.
  static constexpr Duration kReloadPause = std::chrono::milliseconds(500);

  /// Opens the ports of `settings`, but does not accept viewers yet. Throws AddressError or
  /// std::runtime_error, each with one line. The clocks must outlive this object.
  StreamService(const Settings& settings, const Clock& clock, const MediaClock& media_clock,
                const StreamDescription& description, const StreamIdentity& identity);
  /// Ends the service, if end() was not called.
  ~StreamService();
  StreamService(const StreamService&) = delete;
  StreamService& operator=(const StreamService&) = delete;

  /// Sets the function that adds the caller's own figures for --http. Call it before start().
  /// `complete` must be callable until end() or the destruction; thread: the network's.
  void watch(std::function<void(Metrics&)> complete) { complete_metrics_ = std::move(complete); }
  /// Starts the network thread, and the port for operators. `on_signal` is called at SIGINT and
  /// SIGTERM. `on_reload` is called at SIGHUP, unless standard input is a terminal; then SIGHUP
  /// means that the terminal closed, and `on_signal` is called. Thread: the network's. At SIGUSR1
  /// the log receives one line of status.
  void start(std::function<void()> on_signal, std::function<void()> on_reload);
  /// Begins to accept viewers, announces the server on the LAN (--announce), and reports to the
  /// service manager that the server is ready. Call it after start(). A second call does nothing.
  /// `name`: the stream's name.
  void open(const std::string& name);
  /// Sends a goodbye to all viewers and ends the network thread. A second call does nothing.
  void end();

  [[nodiscard]] Broadcaster& broadcaster() { return broadcaster_; }
  /// Returns the context of the network thread. Thread: any.
  [[nodiscard]] asio::io_context& io() { return io_; }
  [[nodiscard]] ServiceManager& manager() { return manager_; }

 private:
  /// Members of UDP delivery.
  struct Datagrams {
    Datagrams(asio::io_context& io, const Clock& clock, const Listener& listener,
              const StreamIdentity& identity, const Settings& settings);
    std::optional<MulticastGroup> group;
    DatagramSender sender;
  };

  void awaitReload();
  void reload();
  void awaitStatusRequest();
  /// Reads certificate, key and tokens again. After an error the present ones stay in use.
  void reloadSecrets();
  [[nodiscard]] Metrics collectMetrics() const;

  const Settings& settings_;
  const Clock& clock_;
  const MediaClock& media_clock_;
  LocalTime started_;
  ServiceManager manager_;
  LimitedLog secrets_log_;  // about certificate, key and tokens
  asio::io_context io_;
  Broadcaster broadcaster_;
  std::optional<TlsContext> tls_;
  std::vector<std::string> host_names_;
  std::optional<PageResponder> page_;  // without --page off
  Listener listener_;
  std::optional<Datagrams> datagrams_;
  std::optional<HttpServer> http_;  // with --http
  std::function<void(Metrics&)> complete_metrics_;
  std::optional<Announcer> announcer_;  // once open() was called
  std::optional<asio::signal_set> signals_;
  std::optional<asio::signal_set> reload_signal_;
  asio::steady_timer reload_pause_{io_};  // until the next reload may begin
  bool reload_waits_ = false;
  std::function<void()> on_reload_;
  std::optional<asio::signal_set> status_signal_;
  bool open_ = false;
  std::jthread network_;  // last member: it runs io_
};

}  // namespace hapticast::server
