// SPDX-License-Identifier: MIT
#include "tests/evaluate/network/network_viewer.hpp"

#include <cmath>
#include <utility>

#include "client/haptics/playback/playout.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::evaluate {

namespace {

class ScriptedViewer {
 public:
  explicit ScriptedViewer(Hand hand)
      : hand_(std::move(hand)),
        preparation_(*pool_, clock_, Method::kHapticast,
                     [this](const client::PreparedFrame& frame) { receiver_.addPrepared(frame); }),
        receiver_(preparation_, state_, 1),
        lookup_(*pool_, defaultVariant().interpolation),
        touch_(defaultVariant().make()) {}

  [[nodiscard]] LocalTime now() const { return clock_.now(); }
  void moveTo(LocalTime now) { clock_.set(now); }
  bool receive(std::span<const std::uint8_t> payload) {
    auto message = decode(payload);
    if (!message.ok()) return false;
    if (auto* const frame = std::get_if<CodedFrame>(&message.value())) {
      receiver_.frame(std::move(*frame), now());
    } else if (const auto* const pong = std::get_if<Pong>(&message.value())) {
      receiver_.pong(*pong, now());
    } else if (const auto* const welcome = std::get_if<Welcome>(&message.value())) {
      receiver_.connected(welcome->description, now());
    }
    prepareAll();
    return true;
  }
  void part(const DatagramHeader& header, std::span<const std::uint8_t> payload) {
    if (receiver_.classify(header) != client::FrameAssembler::Want::kNew) return;
    (void)receiver_.part(header, payload, now());
    prepareAll();
  }
  void expectCopies(std::uint32_t copies) { receiver_.expectCopies(copies, now()); }

  NetworkTick tick() {
    clock_.advance(kTickPeriod);
    receiver_.release(now());
    prepareAll();
    const client::StreamTiming& stream = receiver_.stream();
    const MediaTime play = playout_.advance(now(), stream, in_contact_);
    NetworkTick tick;
    tick.time_s = toSeconds(play);
    const HandPoint hand = hand_(tick.time_s);
    const client::Scene& scene = lookup_.at(play, stream);
    const client::Contact contact = touch_(lookup_, scene, hand.hip_mm, stream.workspace);
    in_contact_ = contact.contact;
    tick.truth_mm = hand.truth_mm;
    if (contact.contact) tick.displacement_mm = contact.displacement_mm;
    tick.delay_ms = 1e3 * toSeconds(playout_.delay());
    if (stream.connected) tick.clock_offset = stream.clock_offset;
    return tick;
  }

 private:
  void prepareAll() {
    while (preparation_.step()) {
    }
  }

  Hand hand_;
  ManualClock clock_{localTime(10.0)};
  std::unique_ptr<client::FramePool> pool_ = std::make_unique<client::FramePool>();
  LatestValue<client::StreamTiming> state_;
  client::InlinePreparation preparation_;
  client::Receiver receiver_;
  client::Playout playout_;
  client::SceneInterpolator lookup_;
  Touch touch_;
  bool in_contact_ = false;
};

}  // namespace

NetworkTrace renderThroughNetwork(const SentStream& stream, const Network& network,
                                  const Hand& hand, double seconds) {
  ScriptedViewer viewer(hand);
  NetworkTrace trace;
  trace.ticks.reserve(static_cast<std::size_t>(seconds * 1e3));
  trace.conversation =
      runSession(stream, network, seconds, viewer, [&](const Wire& wire, NetworkTick tick) {
        const LocalTime now = viewer.now();
        if (tick.clock_offset)
          tick.clock_error_ms = 1e3 * toSeconds(now.time_since_epoch() + *tick.clock_offset -
                                                wire.mediaNow(now).time_since_epoch());
        trace.ticks.push_back(tick);
      });
  return trace;
}

}  // namespace hapticast::evaluate
