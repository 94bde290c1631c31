// SPDX-License-Identifier: MIT
#include "client/app.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <thread>
#include <utility>

#include "client/device/device_profile.hpp"
#include "client/log.hpp"

namespace hapticast::client {

namespace {

constexpr auto kDrainInterval = std::chrono::milliseconds(10);
constexpr int kMaxFaultFiles = 10;

/// What `load` returns; its complaint begins with the flag that brought the file.
template <class Load>
auto loadFor(const char* flag, Load load) {
  try {
    return load();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(flag) + " " + error.what());
  }
}

RoomSettings roomSettings(const Settings& settings) {
  RoomSettings room;
  room.profile = loadFor("--profile", [&] { return loadDeviceProfile(settings.profile); });
  room.method = settings.method;
  room.surface = settings.method == Method::kThesis ? SurfaceKind::kPerturbed : settings.surface;
  return room;
}

HandScript handScript(const Settings& settings, const DeviceProfile& profile) {
  const HandStiffness stiffness{.hand_N_mm = Hand::light().stiffness_N_m * 1e-3,
                                .surface_N_mm = profile.stiffness_N_mm};
  if (settings.hand == "press") return {HandKind::kPress, stiffness};
  if (settings.hand == "slide") return {HandKind::kSlide, stiffness};
  if (settings.hand == "follow") return {HandKind::kFollow, stiffness};
  return {HandKind::kFile, stiffness,
          loadFor("--hand", [&] { return loadHandTargets(settings.hand); })};
}

ConnectionSettings connectionSettings(const Settings& settings, bool wants_video) {
  ConnectionSettings connection;
  connection.server = settings.server;
  connection.wants_video = wants_video;
  return connection;
}

std::string greeting(const StreamDescription& stream, Method method) {
  std::string text = fmt::format("connected: {}, {} x {}, {:g} frames/s", stream.name,
                                 stream.workspace.width_px, stream.workspace.height_px, stream.fps);
  if (method == Method::kThesis && stream.method != Method::kThesis) {
    text +=
        "; --method thesis here, but not on the server: segmentation, smoothing, motion and "
        "workspace stay its own";
  }
  return text;
}

}  // namespace

App::App(Settings settings, const Clock& clock, Views views)
    : settings_(std::move(settings)),
      clock_(clock),
      room_settings_(roomSettings(settings_)),
      hand_(handScript(settings_, room_settings_.profile)),
      device_(room_settings_.profile, Hand::light(), clock, &hand_),
      room_(std::make_unique<Room>(room_settings_, pool_, stream_, user_controls_, latest_report_,
                                   &log_ring_)),
      receiver_(pool_, stream_, {settings_.method, settings_.method == Method::kThesis ? 2 : 1}),
      connection_(io_, clock, connectionSettings(settings_, !views.empty()), receiver_,
                  {.welcomed =
                       [this](const auto& stream) {
                         spdlog::info("{}", greeting(stream, settings_.method));
                         told_why_.clear();
                       },
                   .video = [this](VideoFrame video) { show(std::move(video)); },
                   .disconnected = [this](const std::string& why) { sayOnce(why); },
                   .failed =
                       [this](const std::string& why) {
                         spdlog::error("{}", why);
                         failed_ = true;
                         stop();
                       }}),
      views_(std::move(views)) {
  requireWritable("--log", settings_.log_file);
  requireWritable("--summary", settings_.summary_file);
  if (settings_.log_file.empty()) return;
  log_.open(settings_.log_file);
  writeReportHeading(log_);
}

void App::show(VideoFrame picture) {
  const Workspace workspace = receiver_.stream().workspace;
  for (const auto& view : views_) view->takePicture(picture, workspace);
}

void App::sayOnce(const std::string& why) {
  // An absent server is tried about every second; the reason is told when it is another one.
  if (why != told_why_) spdlog::warn("{}; trying again", why);
  told_why_ = why;
}

bool App::run() {
  spdlog::info(
      "connecting to {}:{} with a virtual device ({}) in a hand that does: {}. Ctrl-C ends it.",
      settings_.server.host, settings_.server.port, room_settings_.profile.name, settings_.hand);
  asio::signal_set signals(io_, SIGINT, SIGTERM);
  signals.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) stop();
  });
  connection_.start();
  std::jthread network([this] { io_.run(); });
  std::atomic<bool> loop_stop{false};
  std::jthread loop([&] {
    realtime_ = requestRealtime();
    runLoop(device_, *room_, clock_, loop_stop, stats_);
  });

  wait();
  loop_stop = true;
  loop.join();
  drain();
  asio::post(io_, [&signals] { signals.cancel(); });
  connection_.stop();
  network.join();
  finish();
  return !failed_;
}

void App::wait() {
  const LocalTime begin = clock_.now();
  while (!stop_ &&
         (settings_.seconds == 0.0 || clock_.now() - begin < fromSeconds(settings_.seconds))) {
    drain();
    dumpFault();
    const TickReport& report = latest_report_.load();
    if (report.contact != told_contact_) {
      told_contact_ = report.contact;
      asio::post(io_, [this, contact = told_contact_] { connection_.setInContact(contact); });
    }
    if (settings_.rearm && deviceIsBack(report)) {
      ++user_.rearm;
      user_controls_.store(user_);
    }
    for (const auto& view : views_) {
      if (!view->turn()) stop();
    }
    std::this_thread::sleep_for(kDrainInterval);
  }
}

void App::drain() {
  TickReport report;
  while (log_ring_.tryPop(report)) {
    if (log_.is_open()) writeReport(log_, report);
    for (const auto& view : views_) view->takeReport(report);
  }
}

void App::dumpFault() {
  FlightRecorder& recorder = room_->recorder();
  if (!recorder.frozen() || faults_dumped_ == kMaxFaultFiles) return;
  const std::string file = fmt::format("hapticast-fault-{}.csv", ++faults_dumped_);
  const Fault fault = recorder.at(recorder.size() - 1).fault;
  std::ofstream out(file);
  dumpRecorder(out, recorder);
  out.close();
  spdlog::warn("fault: {}; the ticks before it are {}", faultName(fault),
               out ? "in " + file : "lost, no file can be written here");
}

RunResult App::result() const {
  return {.loop = stats_,
          .frames = receiver_.counts(),
          .bytes_received = connection_.bytesReceived(),
          .playout_delay_ms = toSeconds(room_->report().playout_delay) * 1e3,
          .clock_offset_us = toSeconds(receiver_.stream().clock_offset) * 1e6,
          .clock_error_us = toSeconds(receiver_.clockErrorBound()) * 1e6,
          .realtime = realtime_};
}

void App::finish() {
  dumpFault();
  if (!realtime_.fifo || !realtime_.mlock) {
    spdlog::info("the loop ran without {}: ticks may be late under load (README: real time)",
                 realtime_.fifo    ? "locked memory"
                 : realtime_.mlock ? "SCHED_FIFO"
                                   : "SCHED_FIFO and locked memory");
  }
  if (room_->droppedReports() > 0)
    spdlog::warn("{} ticks are missing in the log", room_->droppedReports());
  if (log_.is_open()) {
    log_.close();
    if (!log_)
      throw std::runtime_error("--log " + settings_.log_file +
                               ": not written completely; is the disk full?");
  }
  const RunResult run = result();
  if (!settings_.summary_file.empty()) writeSummary(settings_.summary_file, run);
  for (const auto& view : views_) view->finish();
  if (!settings_.quiet && !failed_) std::fputs(inWords(run).c_str(), stdout);
}

}  // namespace hapticast::client
