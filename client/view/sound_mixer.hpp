// SPDX-License-Identifier: MIT
// Converts the force to sound. The sustained component of the force (force_components.hpp) controls
// the amplitude of a low tone, and the transient component that of a high tone. A beep is a third
// tone. The amplitudes change gradually, because a step of an amplitude is an audible click.
// Thread: one at a time.
#pragma once

#include <cstdint>
#include <span>

#include "client/haptics/force_components.hpp"

namespace hapticast::client {

/// Input of the mixer. The struct owns no memory.
struct SoundCue {
  ForceComponents force;
  std::uint64_t tick = 0;   ///< number of the tick that computed the force
  std::uint32_t beeps = 0;  ///< a new value: a beep
};

/// Generates the samples of the tones.
class SoundMixer {
 public:
  static constexpr int kRate_Hz = 48000;
  /// Largest magnitude of a sample. The full scale of a sample is 1. The value is a choice.
  static constexpr double kLoudest = 0.5;

  /// Writes the next samples, each within -kLoudest..kLoudest. If `cue` does not change for 0.1 s,
  /// the sound fades out.
  void fill(std::span<float> samples, const SoundCue& cue) noexcept;

 private:
  struct Voice {
    double pitch_Hz;
    double smoothing_s;
    double loudness = 0.0;
    double phase = 0.0;  // in periods, 0..1
    double next(double wanted) noexcept;
  };
  // The values are a choice: pitches that a small loudspeaker can play and that differ clearly. The
  // hum changes slowly. The high sound changes fast, because a blow must not be late.
  Voice sustained_{.pitch_Hz = 220.0, .smoothing_s = 0.015};
  Voice transient_{.pitch_Hz = 1100.0, .smoothing_s = 0.003};
  Voice beep_{.pitch_Hz = 880.0, .smoothing_s = 0.003};
  std::uint64_t tick_ = 0;
  std::uint32_t beeps_ = 0;
  std::size_t beep_left_ = 0;  // samples of the present beep to come
  std::size_t age_ = 0;        // samples since the last change of the tick
};

}  // namespace hapticast::client
