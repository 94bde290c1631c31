// SPDX-License-Identifier: MIT
#include "client/web/viewer.hpp"

#include <algorithm>
#include <utility>

#include "common/transport/clock_sync.hpp"

namespace hapticast::client {

namespace {

// As Connection: the first pings are quick, so that the clocks are soon synchronised.
constexpr Duration kBurstInterval = std::chrono::milliseconds(20);
constexpr Duration kPingInterval = std::chrono::seconds(1);
// A page reads the history with each picture. Chosen: a second, also while a page is hidden.
constexpr std::size_t kMostHistory = std::size_t{4} * 1000;
// Limit of the pointer's position: beyond any workspace that a server may announce.
constexpr double kMost_mm = 1000.0;

RendererSettings makeSettings() {
  RendererSettings settings;
  settings.profile = PlantProfile();
  settings.profile.name = "page";
  return settings;
}

}  // namespace

WebViewer::WebViewer(OriginPin origin)
    : settings_(makeSettings()),
      preparation_(pool_, clock_, Method::kHapticast,
                   [this](const PreparedFrame& frame) {
                     receiver_.addPrepared(frame);
                     reliefs_ = frame.playable;
                   }),
      receiver_(preparation_, timing_, 1),
      messages_(receiver_, std::move(origin)),
      hand_(PlantProfile(), clock_),
      renderer_(settings_, pool_, timing_, user_, nullptr) {
  ui_.pointer_is_device = true;
}

std::vector<std::uint8_t> WebViewer::makeHello(const std::string& access_token) {
  return encode(Hello{kProtocolVersion, "web page", true, true, access_token});
}

Result<Message, WireError> WebViewer::receive(std::span<const std::uint8_t> bytes, LocalTime now) {
  clock_.set(now);
  auto message = messages_.receive(bytes, clock_.now());
  ui_.stream.connected = messages_.welcomed();
  if (!message.ok()) return message;
  if (std::holds_alternative<Welcome>(message.value())) {
    sent_pings_ = 0;
    next_ping_ = clock_.now();
    report_due_ = false;
    ui_.stream.scan_share = 1.0;
  } else if (const auto* const preparing = std::get_if<Preparing>(&message.value())) {
    ui_.stream.scan_share = preparing->share;
  } else if (std::holds_alternative<CodedFrame>(message.value())) {
    ui_.stream.scan_share = 1.0;
  }
  return message;
}

bool WebViewer::prepareNext(LocalTime now) {
  clock_.set(now);
  receiver_.release(clock_.now());
  return preparation_.step();
}

std::optional<std::vector<std::uint8_t>> WebViewer::poll(LocalTime now) {
  clock_.set(now);
  if (!messages_.welcomed()) return std::nullopt;
  if (std::exchange(report_due_, false)) return encode(makeReport());
  if (clock_.now() < next_ping_) return std::nullopt;
  const bool burst = ++sent_pings_ < ClockSync::kBurst;
  next_ping_ = clock_.now() + (burst ? kBurstInterval : kPingInterval);
  report_due_ = !burst;
  return encode(Ping{clock_.now()});
}

void WebViewer::disconnect(LocalTime now) {
  clock_.set(now);
  messages_.disconnect(clock_.now());
  ui_.stream.connected = false;
}

ReceiverReport WebViewer::makeReport() const {
  const ReceiverCounts& counts = receiver_.counts();
  return {counts.received,
          counts.lost,
          counts.late,
          1e3 * toSeconds(receiver_.stream().playout_delay_target),
          1e6 * toSeconds(receiver_.clockErrorBound()),
          report().contact};
}

void WebViewer::point(const Vec3& position_mm) {
  if (position_mm.allFinite()) target_mm_ = position_mm.cwiseMax(-kMost_mm).cwiseMin(kMost_mm);
}

void WebViewer::setControls(const UserControls& controls) {
  ui_.user = controls;
  ui_.user.number = user_.load().number + 1;
  user_.store(ui_.user);
}

const TickReport& WebViewer::tick(LocalTime now) {
  clock_.set(now);
  if (target_mm_) hand_.moveTowards(mapping().toDevice(*target_mm_));
  return render(clock_.now(), hand_.exchange(force_N_, report()));
}

const TickReport& WebViewer::tickAt(LocalTime now, const Vec3& position_mm) {
  clock_.set(now);
  DeviceState reading;
  reading.position_mm = position_mm;
  reading.time = clock_.now();
  return render(clock_.now(), reading);
}

const TickReport& WebViewer::render(LocalTime now, const DeviceState& reading) {
  const TickReport& report = renderer_.tick(now, reading);
  force_N_ = report.force_N;
  ticks_.add(report);
  if (history_.size() < kMostHistory)
    for (const double value : {report.force_N.norm(), report.static_force_N.norm(),
                               report.dynamic_force_N.norm(), report.contact ? 1.0 : 0.0})
      history_.push_back(static_cast<float>(value));
  return report;
}

std::string WebViewer::stateLine() const {
  TickReport shown = report();
  // One late timer of a page sets this state for a minute. The page counts late ticks itself.
  shown.safety_states &= ~bit(SafetyState::kLateMachine);
  return stateLines(shown);
}

MediaTime WebViewer::mediaNow(LocalTime now) const {
  const StreamTiming& timing = receiver_.stream();
  return timing.connected ? MediaTime(now.time_since_epoch() + timing.clock_offset) : MediaTime{};
}

}  // namespace hapticast::client
