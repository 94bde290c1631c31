// SPDX-License-Identifier: MIT
#include "client/view/sound_mixer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace hapticast::client {

namespace {

// Chosen: silence for a hardly noticeable force; full volume at 2 N, a firm press.
constexpr double kSilent_N = 0.05;
constexpr double kLoud_N = 2.0;
// Chosen: after this time without a new cue the main thread has stopped.
constexpr std::size_t kStale = SoundMixer::kRate_Hz / 10;
// Chosen: 0.15 s.
constexpr std::size_t kBeep = SoundMixer::kRate_Hz * 3 / 20;

double loudness(double force_N) noexcept {
  return 0.5 * SoundMixer::kLoudest *
         std::clamp((force_N - kSilent_N) / (kLoud_N - kSilent_N), 0.0, 1.0);
}

}  // namespace

double SoundMixer::Voice::next(double wanted) noexcept {
  loudness += (wanted - loudness) / (smoothing_s * kRate_Hz);
  phase += pitch_Hz / kRate_Hz;
  phase -= std::floor(phase);
  return loudness * std::sin(2.0 * std::numbers::pi * phase);
}

void SoundMixer::fill(std::span<float> samples, const SoundCue& cue) noexcept {
  age_ = cue.tick == tick_ ? age_ + samples.size() : 0;
  tick_ = cue.tick;
  const ForceComponents heard = age_ > kStale ? ForceComponents{} : cue.force;
  const double press = loudness(heard.sustained_N);
  const double blow = loudness(heard.transient_N);
  if (cue.beeps != std::exchange(beeps_, cue.beeps)) beep_left_ = kBeep;
  for (float& sample : samples) {
    const double beep = beep_left_ > 0 ? 0.5 * kLoudest : 0.0;
    if (beep_left_ > 0) --beep_left_;
    const double sum = sustained_.next(press) + transient_.next(blow) + beep_.next(beep);
    sample = static_cast<float>(std::clamp(sum, -kLoudest, kLoudest));
  }
}

}  // namespace hapticast::client
