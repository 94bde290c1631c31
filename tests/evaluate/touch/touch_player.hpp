// SPDX-License-Identifier: MIT
// A stream under a scripted hand, 1000 times a second of play time: bytes decoded, frames
// prepared by the receiver, looked up and touched as the client does, without device and safety
// chain. Thread: any, each player for itself.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/haptics/contact/thesis_interpolation.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"

namespace hapticast::evaluate {

/// Renders a tick. Called once a tick, in order. It may keep state.
using Touch = std::function<client::Contact(const client::SceneInterpolator&, const client::Scene&,
                                            const Vec3& hip_mm, const Workspace&)>;

/// A way to the force: surface model, sampler and interpolation in time.
struct Variant {
  std::string name;
  std::function<Touch()> make;  ///< a fresh one for every run
  client::Interpolation interpolation = client::Interpolation::kHermite;
  Method method = Method::kHapticast;  ///< of the server and of the receiver's preparation
  bool is_default = false;
  bool is_thesis = false;
};

/// All of them; the default is the first.
std::vector<Variant> allVariants();
const Variant& defaultVariant();
const Variant& thesisVariant();

/// Where the hand is at a time, and the exact displacement expected there (zero: no contact).
struct HandPoint {
  Vec3 hip_mm = Vec3::Zero();
  Vec3 truth_mm = Vec3::Zero();
};
using Hand = std::function<HandPoint(double time_s)>;

struct Tick {
  double time_s = 0.0;
  HandPoint hand;
  Vec3 displacement_mm = Vec3::Zero();  ///< of the surface model; zero without contact
  Vec3 normal = Vec3::UnitZ();          ///< as the surface model says
  bool contact = false;
  bool new_frame = false;  ///< in this tick play time reaches a frame, or one has come

  [[nodiscard]] bool trulyTouches() const { return hand.truth_mm != Vec3::Zero(); }
  [[nodiscard]] Vec3 error_mm() const { return displacement_mm - hand.truth_mm; }
};

struct ForceTrace {
  std::vector<Tick> ticks;
  double tick_us = 0.0;  ///< look-up and surface, mean
};

struct PlayTimes {
  double from_s = 0.4;
  double to_s = 1e9;         ///< at most the stream's last frame but one
  double arrival_s = -0.08;  ///< when a frame comes, after its media time; at -0.08 all are there
                             ///< that any interpolation asks for
};

/// The force at a hand by each of the variants; frames are made once for those that read the same
/// ones. `streams` gives the stream of a method.
std::vector<ForceTrace> renderTraces(const std::function<const Stream&(Method)>& streams,
                                     const std::vector<Variant>& variants, const Hand& hand,
                                     const PlayTimes& times = {});

/// One variant. `look`: what else is wanted of each tick; its time counts.
using Look = std::function<void(const client::Scene&, const client::StreamTiming&,
                                const client::Contact&, const Tick&)>;
ForceTrace renderTrace(const Stream& stream, const Variant& variant, const Hand& hand,
                       const PlayTimes& times = {}, const Look& look = nullptr);

/// Relative RMS of the error over the ticks in which the truth is in contact.
double relativeError(const std::vector<Tick>& ticks);

}  // namespace hapticast::evaluate
