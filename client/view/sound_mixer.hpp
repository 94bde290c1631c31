// SPDX-License-Identifier: MIT
// Sonification of the force: a low hum for the sustained component, a high one for the transient
// component. The amplitude never steps, so that only a blow clicks.
// Thread: one at a time.
#pragma once

#include <cstdint>
#include <span>

#include "client/haptics/force_components.hpp"

namespace hapticast::client {

/// Input of the mixer, without ownership.
struct SoundCue {
  ForceComponents force;
  std::uint64_t tick = 0;  ///< tick of the force
};

class SoundMixer {
 public:
  static constexpr int kRate_Hz = 48000;
  /// Limit of all samples. Chosen: half of the full scale.
  static constexpr double kLoudest = 0.5;

  /// Computes the next samples, -kLoudest..kLoudest. With an unchanged cue the sound fades.
  void fill(std::span<float> samples, const SoundCue& cue) noexcept;

 private:
  struct Voice {
    double pitch_Hz;
    double smoothing_s;
    double loudness = 0.0;
    double phase = 0.0;  // in turns
    double next(double wanted) noexcept;
  };
  // Chosen: pitches of a small loudspeaker that differ clearly. The hum follows the hand; a blow
  // has no delay.
  Voice sustained_{.pitch_Hz = 220.0, .smoothing_s = 0.015};
  Voice transient_{.pitch_Hz = 1100.0, .smoothing_s = 0.003};
  std::uint64_t tick_ = 0;
  std::size_t age_ = 0;  // samples since the last change of the tick
};

}  // namespace hapticast::client
