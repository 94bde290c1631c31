// SPDX-License-Identifier: MIT
// What a force sounds like: a low hum as loud as the press, a high one for a moment where it is
// sudden. Loudness never steps, so that nothing clicks but a blow. Thread: one at a time.
#pragma once

#include <cstdint>
#include <span>

#include "client/haptics/force_components.hpp"

namespace hapticast::client {

/// What is to be heard now. A plain value that owns nothing.
struct SoundCue {
  ForceComponents force;
  std::uint64_t tick = 0;  ///< that it was felt in
};

class SoundMixer {
 public:
  static constexpr int kRate_Hz = 48000;
  /// No sample is beyond it: chosen, half of what there is.
  static constexpr double kLoudest = 0.5;

  /// The next samples, -kLoudest..kLoudest. A cue that does not change fades away.
  void fill(std::span<float> samples, const SoundCue& cue) noexcept;

 private:
  struct Voice {
    double pitch_Hz;
    double smoothing_s;
    double loudness = 0.0;
    double phase = 0.0;  // in turns
    double next(double wanted) noexcept;
  };
  // Chosen: what a small loudspeaker can play, far enough apart to be told from each other; the hum
  // follows a hand, a blow is there at once.
  Voice sustained_{.pitch_Hz = 220.0, .smoothing_s = 0.015};
  Voice transient_{.pitch_Hz = 1100.0, .smoothing_s = 0.003};
  std::uint64_t tick_ = 0;
  std::size_t age_ = 0;  // samples since it changed
};

}  // namespace hapticast::client
