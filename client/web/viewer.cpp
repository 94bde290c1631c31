// SPDX-License-Identifier: MIT
#include "client/web/viewer.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {

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

SessionSettings makeSessionSettings(OriginPin origin, std::string access_token, std::string name) {
  SessionSettings settings;
  settings.origin = std::move(origin);
  settings.client_name = name.empty() ? "web page" : std::move(name);
  settings.access_token = std::move(access_token);
  settings.wants_video = true;
  settings.wants_acts = true;
  return settings;
}

}  // namespace

WebViewer::WebViewer(OriginPin origin, std::string access_token, std::string name)
    : settings_(makeSettings()),
      preparation_(pool_, clock_, Method::kHapticast,
                   [this](const PreparedFrame& frame) {
                     receiver_.addPrepared(frame);
                     reliefs_ = frame.playable;
                   }),
      receiver_(preparation_, timing_, 1),
      session_(makeSessionSettings(std::move(origin), std::move(access_token), std::move(name)),
               &receiver_),
      hand_(PlantProfile(), clock_),
      renderer_(settings_, pool_, timing_, user_, nullptr) {
  ui_.pointer_is_device = true;
}

bool WebViewer::open(Protection protection, LocalTime now) {
  clock_.set(now);
  const auto refusal = session_.open(protection, clock_.now());
  if (refusal) end_ = *refusal;
  return !refusal;
}

std::optional<Message> WebViewer::receive(std::span<const std::uint8_t> bytes, LocalTime now) {
  clock_.set(now);
  auto message = session_.receive(bytes, clock_.now());
  if (!message.ok()) {
    end_ = message.error();
    return std::nullopt;
  }
  ui_.stream.connected = session_.welcomed();
  ui_.stream.picture_reduced = session_.arePicturesReduced();
  if (const auto* const preparing = std::get_if<Preparing>(&message.value())) {
    ui_.stream.scan_share = preparing->share;
  } else if (std::holds_alternative<Welcome>(message.value()) ||
             std::holds_alternative<CodedFrame>(message.value())) {
    ui_.stream.scan_share = 1.0;
  }
  return std::move(message).value();
}

bool WebViewer::prepareNext(LocalTime now) {
  clock_.set(now);
  receiver_.release(clock_.now());
  return preparation_.step();
}

std::optional<std::vector<std::uint8_t>> WebViewer::poll(LocalTime now) {
  clock_.set(now);
  session_.setInContact(report().contact);
  const auto message = session_.poll(clock_.now());
  if (!message) return std::nullopt;
  return encode(*message);
}

bool WebViewer::expire(LocalTime now) {
  clock_.set(now);
  auto end = session_.expire(clock_.now());
  if (end) end_ = std::move(*end);
  return end.has_value();
}

std::optional<Duration> WebViewer::close(LocalTime now) {
  clock_.set(now);
  ui_.stream.connected = false;
  return session_.close(end_, clock_.now());
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
  return stateLines(shown, ui_.stream);
}

MediaTime WebViewer::mediaNow(LocalTime now) const {
  const StreamTiming& timing = receiver_.stream();
  return timing.connected ? MediaTime(now.time_since_epoch() + timing.clock_offset) : MediaTime{};
}

}  // namespace hapticast::client
