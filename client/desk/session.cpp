// SPDX-License-Identifier: MIT
#include "client/desk/session.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <thread>
#include <utility>

#include "client/net/connection.hpp"
#include "client/net/decode_thread.hpp"
#include "client/net/receiver.hpp"
#include "client/report/messages.hpp"
#include "client/servers/find_server.hpp"
#include "client/servers/server_trust.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

namespace {

ConnectionSettings connectionSettings(const Settings& settings, bool wants_video) {
  const std::string server = nameServer(settings);
  ConnectionSettings to;
  static_cast<SessionSettings&>(to) = makeSessionSettings(settings, server);
  to.server = settings.server;
  to.dial = chooseDial(settings, server);
  to.delivery = settings.delivery;
  to.wants_video = wants_video;
  return to;
}

void logLine(spdlog::level::level_enum level, const std::optional<std::string>& line) {
  if (line) spdlog::log(level, "{}", *line);
}

}  // namespace

class Session::Impl {
 public:
  Impl(const Settings& settings, Desk& desk, const StreamTiming& before)
      : method(settings.method),
        desk(desk),
        recorder(desk.recorder()),
        clock(desk.clock()),
        server_given(settings.server_given),
        server(nameServer(settings)),
        decode_thread(desk.local().pool, clock, settings.method,
                      [this](const PreparedFrame& frame) {
                        asio::post(io, [this, frame] { onPrepared(frame); });
                      }),
        receiver(decode_thread, desk.local().stream, settings.method == Method::kThesis ? 2 : 1,
                 fromSeconds(1e-3 * settings.max_delay_ms), before),
        connection(io, clock,
                   connectionSettings(settings, desk.ui().wantsVideo() || recorder != nullptr),
                   receiver, allEvents()),
        late_frames(settings.max_delay_ms),
        connection_log(server) {
    if (recorder != nullptr) recorder->attachTo(receiver);
  }

  ~Impl() {
    io.stop();  // an exception can end the client without stop()
  }

  [[nodiscard]] ConnectionEvents connectionEvents();
  /// Returns connectionEvents(), and the changes of the description.
  [[nodiscard]] ConnectionEvents allEvents();
  void onPrepared(const PreparedFrame& frame);
  void publishStats(bool connected);
  void connect();
  void stop();

  const Method method;
  Desk& desk;
  RunRecorder* const recorder;  // null: no recording
  const Clock& clock;
  const bool server_given;
  const std::string server;
  LatestValue<ConnectionStats> stats;  // the network thread writes it
  bool in_contact = false;             // last value of setInContact(), whose thread has it
  asio::io_context io;
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  DecodeThread decode_thread;
  Receiver receiver;
  Connection connection;
  double scan_share = 1.0;              // of the server's clip; network thread
  std::optional<Timeline> timeline;     // of this viewer; network thread
  StreamErrorLog stream_errors;         // network thread
  LateFrameLog late_frames;             // network thread
  ConnectionLog connection_log;         // network thread; after it has ended the caller's
  std::atomic<bool> is_waiting{false};  // for the first connection, after a failed one
  std::atomic<bool> failed{false};
  ServerHint server_hint;
  std::jthread network;  // last: it uses everything above
};

ConnectionEvents Session::Impl::connectionEvents() {
  return {.welcomed =
              [this](const auto& stream) {
                scan_share = 1.0;
                timeline = stream.timeline;
                publishStats(true);
                if (recorder != nullptr) recorder->onDescription(stream);
                is_waiting = false;
                logLine(spdlog::level::info,
                        connection_log.connected(greeting(stream, method), clock.now()));
              },
          .video =
              [this](const VideoFrame& video) {
                if (recorder != nullptr) recorder->onPicture(video);
                desk.ui().onPicture(video, receiver.stream().workspace);
              },
          .preparing =
              [this](double share) {
                scan_share = share;
                publishStats(true);
                logLine(spdlog::level::info, connection_log.preparing(share, clock.now()));
              },
          .delivery =
              [this](const std::string& line) {
                logLine(spdlog::level::info, connection_log.onMessage(line, clock.now()));
              },
          .disconnected =
              [this](const std::string& why) {
                publishStats(false);
                is_waiting = !connection_log.everConnected();
                logLine(spdlog::level::warn, connection_log.logLoss(why, clock.now()));
              },
          .failed =
              [this](const std::string& why) {
                const bool names_server = why.find(server) != std::string::npos;
                spdlog::error("{}", names_server ? why : server + ": " + why);
                failed = true;
                desk.stop();
              }};
}

ConnectionEvents Session::Impl::allEvents() {
  ConnectionEvents all = connectionEvents();
  all.described = [this](const StreamDescription& to) {
    timeline = to.timeline;
    publishStats(true);
    if (recorder != nullptr) recorder->onDescription(to);
  };
  return all;
}

void Session::Impl::onPrepared(const PreparedFrame& frame) {
  if (recorder != nullptr) recorder->onPrepared(frame);
  receiver.addPrepared(frame);
  scan_share = 1.0;
  desk.ui().onFrame(frame.playable);
  publishStats(true);
  logLine(spdlog::level::warn, stream_errors.onCounts(receiver.counts(), clock.now()));
  logLine(spdlog::level::warn, late_frames.onCounts(receiver.counts(), clock.now()));
}

void Session::Impl::publishStats(bool connected) {
  const ReceiverCounts& counts = receiver.counts();
  stats.store({.connected = connected,
               .frames_received = counts.received,
               .frames_lost = counts.lost,
               .frames_late = counts.late,
               .slices_lost = counts.slices_lost,
               .scan_share = scan_share,
               .picture_reduced = connection.arePicturesReduced(),
               .clock_error_us = toSeconds(receiver.clockErrorBound()) * 1e6,
               .fps = 1.0 / toSeconds(receiver.stream().frame_interval),
               .timeline = timeline});
}

void Session::Impl::connect() {
  decode_thread.start();
  asio::post(io, [this] { connection.start(); });
  network = std::jthread([this] { io.run(); });
}

void Session::Impl::stop() {
  decode_thread.stop();
  connection.stop();
  work.reset();
  if (network.joinable()) network.join();
}

Session::Session(const Settings& settings, Desk& desk, const StreamTiming& before)
    : impl_(std::make_unique<Impl>(settings, desk, before)) {}

Session::~Session() = default;

void Session::connect() { impl_->connect(); }

void Session::stop() { impl_->stop(); }

const ConnectionStats& Session::stats() { return impl_->stats.load(); }

void Session::setInContact(bool contact) {
  if (std::exchange(impl_->in_contact, contact) == contact) return;
  asio::post(impl_->io, [impl = impl_.get(), contact] { impl->connection.setInContact(contact); });
}

void Session::control(const Control& control) {
  asio::post(impl_->io, [impl = impl_.get(), control] { impl->connection.control(control); });
}

std::optional<std::string> Session::listServers(LocalTime now) {
  if (impl_->server_given || !impl_->is_waiting) return std::nullopt;
  return impl_->server_hint.update(now);
}

std::string Session::serverName() const { return impl_->server; }

bool Session::failed() const { return impl_->failed; }

std::optional<std::string> Session::neverConnected() const {
  if (impl_->connection_log.everConnected()) return std::nullopt;
  const std::string& reason = impl_->connection_log.reason();
  return reason.empty() ? "no answer" : reason;
}

StreamTiming Session::findEnd() const { return impl_->receiver.findEnd(); }

void Session::addTo(RunResult& result) const {
  result.frames = impl_->receiver.counts();
  result.bytes_received = impl_->connection.bytesReceived();
  result.datagrams = impl_->connection.datagrams();
  result.delivery = impl_->connection.delivery();
  result.clock_offset_us = toSeconds(impl_->receiver.stream().clock_offset) * 1e6;
  result.clock_error_us = toSeconds(impl_->receiver.clockErrorBound()) * 1e6;
}

}  // namespace hapticast::client
