// SPDX-License-Identifier: MIT
// A viewer in virtual time. Bytes go through the client's own decoder, receiver, decode thread and
// renderer to a virtual device in a hand. The force at the hand is computed from the sent forces
// and the true motion, without the client's counters.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "client/haptics/renderer.hpp"
#include "client/net/client_session.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/udp_socket.hpp"
#include "common/protocol/messages.hpp"
#include "common/time.hpp"
#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {

/// The rendered force, tick by tick.
struct ForceTrace {
  bool finite = true;
  double max_force_N = 0.0;
  double max_rise_N = 0.0;  ///< from tick to tick
  double max_fall_N = 0.0;
  double step_excess_N = 0.0;      ///< by the chain's own meter
  double max_unexplained_N = 0.0;  ///< step beyond K_max |dx| + B |dv| of the tip
  std::vector<double> work_mJ;     ///< into the hand, up to each tick
  std::vector<std::uint32_t> safety_actions;
  std::vector<bool> contact;
  std::uint64_t refused = 0;   ///< messages
  std::uint64_t rejected = 0;  ///< objects, and slices of them
  double last_force_N = 0.0;
  double max_trust_score_ticks = 0.0;
  double metered_mJ = 0.0;  ///< the same work by the client's own meters, at the end

  /// Ticks in which any of these acted.
  [[nodiscard]] std::ptrdiff_t ticksWith(std::uint32_t any) const {
    return std::count_if(safety_actions.begin(), safety_actions.end(),
                         [=](std::uint32_t each) { return (each & any) != 0; });
  }
  /// Largest over any `seconds`; over all of them where it is longer.
  [[nodiscard]] double mostWork_mJ(double seconds) const {
    const auto window = static_cast<std::size_t>(seconds * 1000.0);
    double most_mJ = 0.0;
    for (std::size_t end = 0; end < work_mJ.size(); end += 10) {
      for (std::size_t begin = end > window ? end - window : 0; begin < end; begin += 10) {
        most_mJ = std::max(most_mJ, work_mJ[end] - work_mJ[begin]);
      }
    }
    return most_mJ;
  }
  /// Largest over exactly `seconds` that begin after `from_s`: whole beats of a hand that taps, so
  /// that what a pressed spring gives back is none of it.
  [[nodiscard]] double netWork_mJ(double from_s, double seconds) const {
    const auto window = static_cast<std::size_t>(seconds * 1000.0);
    double most_mJ = -1e9;
    for (auto end = static_cast<std::size_t>(from_s * 1000.0) + window; end < work_mJ.size();
         ++end) {
      most_mJ = std::max(most_mJ, work_mJ[end] - work_mJ[end - window]);
    }
    return most_mJ;
  }
};

class VirtualViewer {
 public:
  /// `script` is copied; null: the tip is nailed to where it is. `settings` are copied.
  VirtualViewer(const RendererSettings& renderer_settings, const PlantProfile& plant,
                const Hand& hand, const HandScript* script)
      : settings_(renderer_settings),
        device_(plant, hand, clock_),
        delay_(static_cast<std::size_t>(plant.delay_ticks)),
        preparation_(*pool_, clock_, settings_.method,
                     [this](const PreparedFrame& frame) {
                       if (on_prepared) on_prepared(frame);
                       receiver_.addPrepared(frame);
                     }),
        receiver_(preparation_, stream_, settings_.method == Method::kThesis ? 2 : 1),
        renderer_(std::make_unique<HapticRenderer>(settings_, *pool_, stream_, user_, nullptr)),
        nailed_(script == nullptr) {
    if (script != nullptr) device_.lead(*script, "a script");
    (void)session_.open({}, clock_.now());
    sent_N_.fill(Vec3::Zero());
  }

  /// Receives a payload as it arrived. Returns false if it is refused: the session is over.
  bool receive(std::span<const std::uint8_t> payload) {
    if (datagram_loss_ && welcomed()) {
      const auto message = decode(payload);
      const auto* const frame = message.ok() ? std::get_if<CodedFrame>(&message.value()) : nullptr;
      if (frame != nullptr) {
        takeParts(*frame);
        countRejected();
        return true;
      }
    }
    const auto message = session_.receive(payload, clock_.now());
    countRejected();
    if (!message.ok()) {
      ++trace.refused;
      disconnect();
    } else if (const auto* const welcome = std::get_if<Welcome>(&message.value())) {
      onWelcome(*welcome);
    }
    return message.ok();
  }
  /// To when something arrives between two ticks; a tick comes a millisecond later.
  void moveTo(LocalTime now) { clock_.set(now); }
  /// A datagram that the server has signed.
  void part(const DatagramHeader& header, std::span<const std::uint8_t> payload) {
    if (receiver_.classify(header) == FrameAssembler::Want::kNew)
      (void)receiver_.part(header, payload, clock_.now());
  }
  void expectCopies(std::uint32_t copies) { receiver_.expectCopies(copies, clock_.now()); }
  /// Takes a datagram's signed body as it came, behind the token that the welcome gave.
  void receiveDatagram(std::span<const std::uint8_t> body) {
    if (!verifier_ || isLost()) return;
    const TokenBytes front = tokenBytes(token_);
    std::vector<std::uint8_t> bytes(front.begin(), front.end());
    bytes.insert(bytes.end(), body.begin(), body.end());
    const auto want = [this](const DatagramHeader& header) { return receiver_.classify(header); };
    const auto datagram = verifier_->verify(bytes, clock_.now(), want);
    if (datagram && !datagram->header.probe())
      (void)receiver_.part(datagram->header, datagram->payload, clock_.now());
    countRejected();
  }
  void disconnect() {
    verifier_.reset();
    (void)session_.close({}, clock_.now());
    (void)session_.open({}, clock_.now());
  }
  [[nodiscard]] bool welcomed() const { return session_.welcomed(); }
  /// Number of welcomes so far. After each one the clock has to be measured again.
  [[nodiscard]] int welcomes() const { return welcomes_; }
  /// A ping, as bytes.
  [[nodiscard]] std::vector<std::uint8_t> ping() const { return encode(Ping{clock_.now()}); }
  [[nodiscard]] LocalTime now() const { return clock_.now(); }
  [[nodiscard]] const ReceiverCounts& counts() const { return receiver_.counts(); }
  void rearm() {
    UserControls wishes = wishes_;
    ++wishes.rearm;
    setControls(wishes);
  }
  [[nodiscard]] const UserControls& controls() const { return wishes_; }
  void setControls(const UserControls& wishes) {
    const std::uint64_t number = wishes_.number + 1;
    wishes_ = wishes;
    wishes_.number = number;
    if (on_controls) on_controls(wishes_);
    user_.store(wishes_);
  }
  /// Functions that receive what the client's recorder receives.
  std::function<void(const PreparedFrame&)> on_prepared;
  std::function<void(const UserControls&)> on_controls;
  [[nodiscard]] Receiver& receiver() { return receiver_; }
  [[nodiscard]] const RendererSettings& settings() const { return settings_; }
  [[nodiscard]] const Clock& clock() const { return clock_; }

  /// A millisecond passes, then the renderer ticks.
  const TickReport& tick() {
    clock_.advance(kTickPeriod);
    receiver_.release(clock_.now());
    while (preparation_.step()) {
    }
    const Vec3 sent_N = renderer_->report().force_N;
    if (target_) {
      const MediaTime next = renderer_->report().play_time + kTickPeriod;
      device_.setTarget(mapping().toDevice(target_(toSeconds(next.time_since_epoch()))));
    }
    const Vec3 from_mm = device_.truePosition_mm();
    const Vec3 speed_mm_s = device_.trueVelocity_mm_s();
    DeviceState state = nailed_ ? DeviceState{nail_mm_, 0, clock_.now(), nail_status_}
                                : device_.exchange(sent_N, renderer_->report());
    const TickReport& report = renderer_->tick(clock_.now(), state);
    recordForce(report, sent_N, nailed_ ? Vec3(Vec3::Zero()) : device_.truePosition_mm() - from_mm,
                device_.trueVelocity_mm_s() - speed_mm_s, state.position_mm);
    return report;
  }
  /// Leads the hand: `target` gives its target (nominal mm) at a play time (s). The tip is free.
  void lead(std::function<Vec3(double)> target) {
    target_ = std::move(target);
    nailed_ = false;
  }
  /// Position of the simulated device, nominal mm.
  [[nodiscard]] Vec3 truePosition_mm() const {
    return mapping().toNominal(device_.truePosition_mm());
  }
  /// Where a nailed tip is, nominal mm.
  void nail(const Vec3& nominal_mm, DeviceStatus status = DeviceStatus::kOk) {
    nail_mm_ = mapping().toDevice(nominal_mm);
    nail_status_ = status;
  }
  /// The force begins to fade for good.
  void stop() { renderer_->stop(); }

  /// Frames that come over TCP are handed on as datagrams, in any order. This share of them is
  /// lost, and of those that come as such. (Signatures change nothing of that: the malicious server
  /// has the key.)
  void byDatagrams(double loss) { datagram_loss_ = loss; }

  ForceTrace trace;

 private:
  [[nodiscard]] DeviceMapping mapping() const {
    return DeviceMapping::fit(Workspace{}, settings_.profile.workspace_mm);
  }
  bool isLost() {
    return datagram_loss_ && std::uniform_real_distribution(0.0, 1.0)(random_) < *datagram_loss_;
  }
  void countRejected() {
    while (preparation_.step()) {
    }
    const ReceiverCounts& counts = receiver_.counts();
    trace.rejected = counts.reliefs_rejected + counts.slices_refused + counts.malformed +
                     (verifier_ ? verifier_->counts().foreign : 0);
  }
  void takeParts(const CodedFrame& frame) {
    std::vector<std::vector<std::uint8_t>> parts = packFrame(frame);
    std::vector<std::size_t> order(parts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random_);
    for (const std::size_t part : order) {
      if (isLost()) continue;
      this->part({1, frame.epoch, frame.id, frame.media_time, static_cast<std::uint16_t>(part),
                  static_cast<std::uint16_t>(parts.size())},
                 parts[part]);
    }
  }
  void onWelcome(const Welcome& welcome) {
    ++welcomes_;
    token_ = welcome.datagram_token;
    if (welcome.verifying_key)
      verifier_.emplace(token_, welcome.stream, VerifyingKey::from(*welcome.verifying_key).value(),
                        keys_);
  }
  static SessionSettings makeSessionSettings() {
    SessionSettings settings;
    settings.sends_pings = false;  // runSession() sends them
    return settings;
  }

  void recordForce(const TickReport& report, const Vec3& sent_N, const Vec3& way_mm,
                   const Vec3& speed_change_mm_s, const Vec3& counted_mm) {
    for (std::size_t i = sent_N_.size() - 1; i > 0; --i) sent_N_[i] = sent_N_[i - 1];
    sent_N_[0] = sent_N;
    const double before_mJ = trace.work_mJ.empty() ? 0.0 : trace.work_mJ.back();
    trace.work_mJ.push_back(before_mJ + sent_N_[delay_].dot(way_mm));
    const double step_N = (report.force_N - sent_N).norm();
    const DeviceProfile& profile = settings_.profile;
    const double stiffest_N_mm = 3.0 * profile.stiffness_N_mm;
    const double hand_N = nailed_ ? 0.0
                                  : stiffest_N_mm * (counted_mm - counted_mm_).norm() +
                                        std::sqrt(stiffest_N_mm * 1e3 * profile.mass_kg) * 1e-3 *
                                            (speed_change_mm_s.norm() + profile.count_mm);
    counted_mm_ = counted_mm;
    trace.finite = trace.finite && report.force_N.allFinite();
    trace.max_force_N = std::max(trace.max_force_N, report.force_N.norm());
    const bool rises = report.force_N.norm() > sent_N.norm();
    double& most_N = rises ? trace.max_rise_N : trace.max_fall_N;
    most_N = std::max(most_N, step_N);
    trace.step_excess_N = std::max(trace.step_excess_N, report.step_excess_N);
    trace.max_unexplained_N = std::max(trace.max_unexplained_N, step_N - hand_N);
    trace.safety_actions.push_back(report.safety_actions);
    trace.contact.push_back(report.contact);
    trace.last_force_N = report.force_N.norm();
    trace.max_trust_score_ticks = std::max(trace.max_trust_score_ticks, report.trust_score_ticks);
    trace.metered_mJ = report.work.user_mJ();
  }

  ManualClock clock_;
  RendererSettings settings_;
  std::unique_ptr<FramePool> pool_ = std::make_unique<FramePool>();
  LatestValue<StreamTiming> stream_;
  LatestValue<UserControls> user_;
  UserControls wishes_;
  VirtualDevice device_;
  std::size_t delay_;
  InlinePreparation preparation_;
  Receiver receiver_;
  std::unique_ptr<HapticRenderer> renderer_;
  bool nailed_;
  DeviceStatus nail_status_ = DeviceStatus::kOk;
  std::function<Vec3(double)> target_;
  ClientSession session_{makeSessionSettings(), &receiver_};
  int welcomes_ = 0;
  DatagramKeyRing keys_;                      // none: its datagrams are not sealed
  std::optional<DatagramVerifier> verifier_;  // where the welcome offers datagrams
  std::uint64_t token_ = 0;
  std::optional<double> datagram_loss_;
  std::mt19937 random_{9};
  Vec3 nail_mm_ = Vec3::Zero();
  Vec3 counted_mm_ = Vec3::Zero();
  std::array<Vec3, VirtualDevice::kLongestDelay_ticks + 1> sent_N_;
};

/// Ignores the reports of a session.
struct NoObserver {
  void operator()(const TickReport&) const {}
};

/// A server with welcome(), messages(until_s) and answer(ping, now_s), times since its welcome,
/// and, if it has datagrams, takeDatagrams(); and a viewer that connects, pings, and comes back
/// after a refusal, as the client does. `observe` is called with the report of every tick.
template <class Server, class Observer = NoObserver>
TickReport runSession(Server& server, VirtualViewer& viewer, double seconds,
                      const Observer& observe = {}) {
  constexpr double kRetry_s = 0.2;
  double welcomed_s = 0.0;
  double next_try_s = 0.0;
  double next_ping_s = 0.0;
  int pings = 0;
  int welcomes = 0;
  TickReport last;
  for (int tick = 0; tick < static_cast<int>(seconds * 1000.0); ++tick) {
    const double now_s = tick * 1e-3;
    const auto take = [&](std::span<const std::uint8_t> message) {
      if (viewer.welcomed() && !viewer.receive(message)) next_try_s = now_s + kRetry_s;
    };
    if (!viewer.welcomed() && now_s >= next_try_s) {
      (void)viewer.receive(server.welcome());
      welcomed_s = now_s;
    }
    if (std::exchange(welcomes, viewer.welcomes()) != viewer.welcomes()) {
      next_ping_s = now_s;
      pings = 0;
    }
    if (viewer.welcomed() && now_s >= next_ping_s) {
      next_ping_s = now_s + (++pings < 8 ? 0.02 : 1.0);
      const auto ping = decode(viewer.ping());
      const auto answer = server.answer(std::get<Ping>(ping.value()), now_s - welcomed_s);
      if (answer) take(*answer);
    }
    if (viewer.welcomed()) {
      for (const auto& message : server.messages(now_s - welcomed_s)) take(message);
      if constexpr (requires { server.takeDatagrams(); }) {
        for (const auto& body : server.takeDatagrams()) viewer.receiveDatagram(body);
      }
    }
    last = viewer.tick();
    observe(last);
  }
  return last;
}

}  // namespace hapticast::client
