// SPDX-License-Identifier: MIT
#include "client/app.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "client/device/buttons.hpp"
#include "client/discovery/find_server.hpp"
#include "client/haptics/loop_thread.hpp"
#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/renderer.hpp"
#include "client/net/connection.hpp"
#include "client/net/receiver.hpp"
#include "client/report/connection_log.hpp"
#include "client/report/fault_log.hpp"
#include "client/report/haptic_status_log.hpp"
#include "client/report/summary.hpp"
#include "client/report/tick_log.hpp"
#include "client/select_device.hpp"
#include "common/cli/signals.hpp"
#include "common/transport/asio.hpp"
#include "common/unique_filename.hpp"

namespace hapticast::client {

namespace {

// Chosen: a window that is drawn in every turn moves smoothly.
constexpr auto kTurn = std::chrono::milliseconds(10);

RendererSettings rendererSettings(const Settings& settings, const DeviceProfile& profile,
                                  bool found) {
  RendererSettings renderer;
  renderer.unconfirmed = found;
  renderer.profile = profile;
  renderer.method = settings.method;
  renderer.stiffness_limit_N_mm = settings.stiffness_limit_N_mm;
  renderer.surface =
      settings.method == Method::kThesis ? SurfaceKind::kPerturbed : settings.surface;
  return renderer;
}

/// The server's name in log lines: HOST:PORT, or mdns:NAME.
std::string serverName(const Settings& settings) {
  return settings.announced.empty() ? toString(settings.server) : "mdns:" + settings.announced;
}

ConnectionSettings connectionSettings(const Settings& settings, bool wants_video) {
  return {.server = settings.server,
          .dial = settings.announced.empty() ? Dial(dialTcp) : dialAnnounced(settings.announced),
          .delivery = settings.delivery,
          .wants_video = wants_video};
}

UserControls userControls(const Settings& settings) {
  UserControls user;
  user.static_on = settings.forces != Forces::kDynamic;
  user.dynamic_on = settings.forces != Forces::kStatic;
  user.method = settings.method;
  user.surface = settings.surface;
  return user;
}

bool points(const Views& views) {
  return std::any_of(views.begin(), views.end(), [](const auto& view) { return view->points(); });
}

bool wantVideo(const Views& views) {
  return std::any_of(views.begin(), views.end(),
                     [](const auto& view) { return view->wantsVideo(); });
}

/// However its scope is left, nothing waits for the network any more.
struct StopOnExit {
  asio::io_context& io;
  ~StopOnExit() { io.stop(); }
};

}  // namespace

class App::Impl {
 public:
  Impl(Settings settings, const Clock& clock, Views views);

  bool run();
  void stop() noexcept { stop_ = true; }

 private:
  [[nodiscard]] ConnectionEvents connectionEvents();
  // On the network's thread:
  void show(const VideoFrame& picture);
  void prepared(const PreparedFrame& frame);
  void logStatus(bool connected);
  // On the calling thread:
  void runEvents();
  void logServers();
  bool updateViews();
  void record();
  void readReports();
  void writeFaults();
  void handleButtons();
  void logContact();
  [[nodiscard]] RunResult result(const LoopThread& loop) const;
  void finish(const LoopThread& loop);

  Settings settings_;
  const Clock& clock_;
  LatestValue<PointerTarget> pointer_;
  Views views_;
  SelectedDevice device_;
  RendererSettings renderer_settings_;
  FramePool pool_;
  LatestValue<StreamTiming> stream_;
  LatestValue<UserControls> user_controls_;
  LatestValue<ConnectionStats> connection_stats_;  // the network's thread writes it
  ServerHint server_hint_;                         // main thread
  UiState ui_state_;                               // main thread
  HapticRenderer::Log log_ring_;
  std::unique_ptr<HapticRenderer> renderer_;  // large: holds the flight recorder
  asio::io_context io_;
  DecodeThread decode_thread_;
  Receiver receiver_;
  Connection connection_;
  LogFile log_;
  std::optional<LogFile> recording_;  // asked for by a view
  FaultLogWriter fault_files_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> failed_{false};
  std::optional<LocalTime> begin_;  // of the first tick
  TickReport last_report_;          // of those taken from log_ring_; its time counts from begin_
  bool logged_contact_ = false;
  RearmPolicy rearm_;
  DeviceButtons buttons_;
  HapticStatusLog status_log_;
  bool time_is_over_ = false;
  std::atomic<bool> is_waiting_{false};  // for the first connection, after a failed one
  StreamErrorLog stream_errors_;         // network thread
  ConnectionLog connection_log_;         // network thread; after it has ended the calling one
};

App::Impl::Impl(Settings settings, const Clock& clock, Views views)
    : settings_(std::move(settings)),
      clock_(clock),
      views_(std::move(views)),
      device_(selectDevice(settings_, clock, points(views_) ? &pointer_ : nullptr)),
      renderer_settings_(
          rendererSettings(settings_, device_.device->profile(), device_.auto_detected)),
      renderer_(std::make_unique<HapticRenderer>(renderer_settings_, pool_, stream_, user_controls_,
                                                 &log_ring_)),
      decode_thread_(pool_, clock, settings_.method,
                     [this](const PreparedFrame& frame) {
                       asio::post(io_, [this, frame] { prepared(frame); });
                     }),
      receiver_(decode_thread_, stream_, settings_.method == Method::kThesis ? 2 : 1),
      connection_(io_, clock, connectionSettings(settings_, wantVideo(views_)), receiver_,
                  connectionEvents()),
      log_(settings_.log_file),
      fault_files_(settings_.fault_folder),
      rearm_(settings_.rearm, points(views_)),
      buttons_(device_.device->profile()),
      connection_log_(serverName(settings_)) {
  requireWritable("--summary", settings_.summary_file);
  ui_state_.user = userControls(settings_);
  user_controls_.store(ui_state_.user);
}

ConnectionEvents App::Impl::connectionEvents() {
  return {.welcomed =
              [this](const auto& stream) {
                logStatus(true);
                is_waiting_ = false;
                const std::string line = greeting(stream, settings_.method);
                if (const auto admitted = connection_log_.connected(line, clock_.now()))
                  spdlog::info("{}", *admitted);
              },
          .video = [this](const VideoFrame& video) { show(video); },
          .preparing =
              [this](double share) {
                if (const auto admitted = connection_log_.preparing(share, clock_.now()))
                  spdlog::info("{}", *admitted);
              },
          .delivery =
              [this](const std::string& line) {
                if (const auto admitted = connection_log_.onMessage(line, clock_.now()))
                  spdlog::info("{}", *admitted);
              },
          .disconnected =
              [this](const std::string& why) {
                logStatus(false);
                is_waiting_ = !connection_log_.everConnected();
                if (const auto admitted = connection_log_.lost(why, clock_.now()))
                  spdlog::warn("{}", *admitted);
              },
          .failed =
              [this](const std::string& why) {
                spdlog::error("{}: {}", serverName(settings_), why);
                failed_ = true;
                stop();
              }};
}

void App::Impl::show(const VideoFrame& picture) {
  const Workspace workspace = receiver_.stream().workspace;
  for (const auto& view : views_) view->onPicture(picture, workspace);
}

void App::Impl::prepared(const PreparedFrame& frame) {
  receiver_.prepared(frame);
  for (const auto& view : views_) view->onFrame(frame.playable);
  logStatus(true);
  if (const auto line = stream_errors_.onCounts(receiver_.counts(), clock_.now()))
    spdlog::warn("{}", *line);
}

void App::Impl::logStatus(bool connected) {
  const ReceiverCounts& counts = receiver_.counts();
  connection_stats_.store({.connected = connected,
                           .frames_received = counts.received,
                           .frames_lost = counts.lost,
                           .frames_late = counts.late,
                           .slices_lost = counts.slices_lost,
                           .clock_error_us = toSeconds(receiver_.clockErrorBound()) * 1e6,
                           .fps = 1.0 / toSeconds(receiver_.stream().frame_interval)});
}

bool App::Impl::run() {
  spdlog::info("connecting to {} with a {}. Ctrl-C ends it.", serverName(settings_),
               device_.device->description());
  if (settings_.forces != Forces::kBoth)
    spdlog::info("felt: the {} force only (--forces)",
                 settings_.forces == Forces::kStatic ? "static" : "dynamic");
  asio::signal_set signals(io_, SIGINT, SIGTERM);
  if (!sighupIgnored()) signals.add(SIGHUP);
  signals.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) stop();  // a second one is not heard: the force has to come down first
  });
  decode_thread_.start();
  connection_.start();
  std::jthread network([this] { io_.run(); });
  const StopOnExit network_stop{io_};
  LoopThread loop(*device_.device, *renderer_, clock_);

  runEvents();
  loop.stop();
  device_.device->poll();
  readReports();
  decode_thread_.stop();
  asio::post(io_, [&signals] { signals.cancel(); });
  connection_.stop();
  network.join();
  finish(loop);
  return !failed_;
}

void App::Impl::runEvents() {
  const LocalTime begin = clock_.now();
  while (!stop_ && !time_is_over_) {
    readReports();
    writeFaults();
    device_.device->poll();
    while (const auto line = device_.device->nextMessage()) spdlog::info("{}", *line);
    logContact();
    if (!updateViews()) stop();
    logServers();
    std::this_thread::sleep_for(kTurn);
    time_is_over_ =
        settings_.seconds > 0.0 && clock_.now() - begin >= fromSeconds(settings_.seconds);
  }
}

/// Nobody named a server, and none answered yet: names those on the LAN.
void App::Impl::logServers() {
  if (settings_.server_given || !is_waiting_) return;
  if (const auto text = server_hint_.update(clock_.now())) spdlog::warn("{}", *text);
}

/// Whether all of them go on.
bool App::Impl::updateViews() {
  ui_state_.stream = connection_stats_.load();
  bool go_on = true;
  for (const auto& view : views_) go_on = view->update(ui_state_) && go_on;
  if (ui_state_.record != recording_.has_value()) record();
  pointer_.store(ui_state_.pointer);
  user_controls_.store(ui_state_.user);
  return go_on;
}

/// A log that is asked for while the client runs begins, or ends.
void App::Impl::record() {
  try {
    if (ui_state_.record) {
      const std::string file = nextFreeFilename(".csv");
      recording_.emplace(file);
      ui_state_.recording = "recording " + file + " (L ends it)";
    } else {
      recording_->close();
      ui_state_.recording = "recorded " + recording_->file();
      recording_.reset();
    }
  } catch (const std::runtime_error& error) {
    ui_state_.recording = error.what();
    ui_state_.record = false;
    recording_.reset();
  }
}

void App::Impl::readReports() {
  while (log_ring_.tryPop(last_report_)) {
    if (!begin_) begin_ = last_report_.time;
    last_report_.time = LocalTime(last_report_.time - *begin_);
    log_.write(last_report_);
    if (recording_) recording_->write(last_report_);
    for (const auto& view : views_) view->onReport(last_report_);
    if (const auto line = status_log_.onReport(last_report_, rearm_)) spdlog::warn("{}", *line);
    handleButtons();
    if (!rearm_.onReport(last_report_)) continue;
    ++ui_state_.user.rearm;
    user_controls_.store(ui_state_.user);
  }
}

/// What the user presses on the device itself.
void App::Impl::handleButtons() {
  const DeviceButtons::ButtonActions actions = buttons_.onButtons(last_report_.buttons);
  if (actions.pause) ui_state_.user.paused = !ui_state_.user.paused;
  if (actions.rearm) ++ui_state_.user.rearm;
  if (actions.pause || actions.rearm) user_controls_.store(ui_state_.user);
  if (actions.other) spdlog::info("button {} of the device was pressed", *actions.other);
}

void App::Impl::writeFaults() {
  // A fault of the very first tick waits until its report has come.
  if (begin_) fault_files_.write(renderer_->recorder(), *begin_);
}

void App::Impl::logContact() {
  if (last_report_.contact == logged_contact_) return;
  logged_contact_ = last_report_.contact;
  asio::post(io_, [this, contact = logged_contact_] { connection_.setInContact(contact); });
}

RunResult App::Impl::result(const LoopThread& loop) const {
  Histogram eye_hand;
  for (const auto& view : views_) {
    if (view->eyeHand() != nullptr) eye_hand = *view->eyeHand();
  }
  return {.loop = loop.stats(),
          .frames = receiver_.counts(),
          .bytes_received = connection_.bytesReceived(),
          .datagrams = connection_.datagrams(),
          .delivery = connection_.delivery(),
          .playout_delay_ms = toSeconds(renderer_->report().playout_delay) * 1e3,
          .clock_offset_us = toSeconds(receiver_.stream().clock_offset) * 1e6,
          .clock_error_us = toSeconds(receiver_.clockErrorBound()) * 1e6,
          .eye_hand_ns = eye_hand,
          .device = device_.device->traffic(),
          .realtime = loop.realtime()};
}

void App::Impl::finish(const LoopThread& loop) {
  writeFaults();
  if (time_is_over_ && !failed_ && !connection_log_.everConnected()) {
    spdlog::error("no server came to {} in {:g} s ({})", serverName(settings_), settings_.seconds,
                  connection_log_.reason().empty() ? "no answer" : connection_log_.reason());
    failed_ = true;
  }
  const RealtimeGrant& realtime = loop.realtime();
  if (!realtime.fifo || !realtime.mlock) {
    spdlog::info("the loop ran without {}: ticks may be late under load (README: real time)",
                 realtime.fifo    ? "locked memory"
                 : realtime.mlock ? "SCHED_FIFO"
                                  : "SCHED_FIFO and locked memory");
  }
  if (renderer_->droppedReports() > 0)
    spdlog::warn("{} ticks are missing in the log", renderer_->droppedReports());
  log_.close();
  if (recording_) recording_->close();
  const RunResult run = result(loop);
  if (!settings_.summary_file.empty()) writeSummary(settings_.summary_file, run);
  for (const auto& view : views_) view->finish();
  if (!settings_.quiet && !failed_) std::fputs(toText(run).c_str(), stdout);
}

App::App(Settings settings, const Clock& clock, Views views)
    : impl_(std::make_unique<Impl>(std::move(settings), clock, std::move(views))) {}

App::~App() = default;

bool App::run() { return impl_->run(); }

void App::stop() noexcept { impl_->stop(); }

}  // namespace hapticast::client
