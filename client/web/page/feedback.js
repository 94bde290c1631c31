// SPDX-License-Identifier: MIT
// What a browser can do to a hand: rumble of a gamepad, vibration of a phone, and sound.
// As in the native client, the force has two parts: the sustained one (the rendered share of the
// static force) drives the strong motor and a low tone, the transient one (the dynamic force, or a
// sudden change) drives the weak motor and a high tone. All are off at once without a contact,
// without fresh data, and in a hidden page.

import {findPad} from './gamepad.js';
import {norm} from './geometry.js';
import {computeRenderedShare} from './overlay.js';

const kSudden_ticks = 50;  // of the low-pass and of the peak hold
const kNothing_N = 0.01;
const kFull_N = 2;  // of a motor and of the sound
const kSilent_N = 0.05;
const kLoudest = 0.25;  // of each tone
const kStale_ms = 100;
const kRenew_ms = 50;   // of a rumble of 100 ms
const kPulse_ms = 100;  // of the vibration: its duty is the strength
const kTones = [{pitch_Hz: 220, smoothing_s: 0.015}, {pitch_Hz: 1100, smoothing_s: 0.003}];

/// Perceived vibration grows with the square of the motor's speed. Hence the root.
const computeLevel = force_N => Math.sqrt(Math.min(1, Math.max(0, force_N / kFull_N)));

function computeLoudness(force_N) {
  return kLoudest * Math.min(1, Math.max(0, (force_N - kSilent_N) / (kFull_N - kSilent_N)));
}

/// What this browser has.
export function findAbilities() {
  const actuator = findPad()?.vibrationActuator;
  return {
    rumble: Boolean(actuator?.playEffect) || 'GamepadHapticActuator' in window,
    pad: Boolean(actuator?.playEffect),
    vibration: 'vibrate' in navigator,
    sound: 'AudioContext' in window,
  };
}

export class Feedback {
  slow_N = 0;
  sustained_N = 0;
  transient_N = 0;
  fresh_ms = -Infinity;
  rumbled_ms = 0;
  pulsed_ms = 0;
  isOn = false;

  /// `settings` has the switches rumble, vibration and sound.
  constructor(settings) {
    this.settings = settings;
    setInterval(() => this.drive(), kRenew_ms);
    document.addEventListener('visibilitychange', () => this.drive());
    addEventListener('pagehide', () => this.stop());
  }

  /// Adds the ticks of a message: their force's magnitude, static, dynamic part and contact.
  add(report, history) {
    const isFelt = report.contact && report.lookup !== 'none' && report.lookup !== 'faded';
    const share = isFelt ? computeRenderedShare(report) : 0;
    for (let i = 0; i < history.length; i += 4) {
      const force_N = isFelt ? history[i] : 0;
      if (!(force_N > kNothing_N)) {
        this.slow_N = this.transient_N = 0;
        continue;
      }
      this.slow_N += (force_N - this.slow_N) / kSudden_ticks;
      const now_N = Math.max(Math.abs(force_N - this.slow_N), share * history[i + 2]);
      this.transient_N = Math.max(now_N, (1 - 1 / kSudden_ticks) * this.transient_N);
    }
    this.sustained_N = share * norm(report.static_force_N);
    if (!isFelt || norm(report.force_N) <= kNothing_N) this.sustained_N = this.transient_N = 0;
    this.fresh_ms = performance.now();
    this.drive();
  }

  isFelt() {
    const isFresh = performance.now() - this.fresh_ms < kStale_ms;
    return isFresh && !document.hidden && this.sustained_N + this.transient_N > kNothing_N;
  }

  /// Renews all outputs, or ends them.
  drive() {
    if (!this.isFelt()) return this.isOn ? this.stop() : undefined;
    this.isOn = true;
    const now_ms = performance.now();
    if (this.settings.rumble && now_ms - this.rumbled_ms >= kRenew_ms - 5) {
      this.rumbled_ms = now_ms;
      this.rumble(findPad());
    }
    if (this.settings.vibration && now_ms - this.pulsed_ms >= kPulse_ms - 5) {
      this.pulsed_ms = now_ms;
      this.vibrate(
          Math.round(kPulse_ms * computeLevel(Math.max(this.sustained_N, this.transient_N))));
    }
    this.play(computeLoudness(this.sustained_N), computeLoudness(this.transient_N));
  }

  rumble(pad) {
    this.pad = pad;
    const effect = {
      duration: 2 * kRenew_ms,
      strongMagnitude: computeLevel(this.sustained_N),
      weakMagnitude: computeLevel(this.transient_N),
    };
    pad?.vibrationActuator?.playEffect?.('dual-rumble', effect)?.catch?.(() => {});
  }

  /// Browsers vibrate from the user's first tap on.
  vibrate(pulse_ms) {
    if (navigator.userActivation?.hasBeenActive ?? true) navigator.vibrate?.(pulse_ms);
  }

  stop() {
    this.isOn = false;
    this.pad?.vibrationActuator?.reset?.()?.catch?.(() => {});
    this.pad = null;
    if (this.pulsed_ms > 0) this.vibrate(0);
    this.pulsed_ms = 0;
    this.play(0, 0);
  }

  /// Browsers permit sound only from a user's gesture on: call this from its event.
  startSound() {
    if (!this.settings.sound || !findAbilities().sound) return;
    if (!this.audio) {
      this.audio = new AudioContext();
      this.tones = kTones.map(({pitch_Hz, smoothing_s}) => {
        const tone = new OscillatorNode(this.audio, {frequency: pitch_Hz});
        const volume = new GainNode(this.audio, {gain: 0});
        tone.connect(volume).connect(this.audio.destination);
        tone.start();
        return {gain: volume.gain, smoothing_s};
      });
    }
    if (this.audio.state !== 'running') this.audio.resume().catch(() => {});
  }

  play(...loudness) {
    this.tones?.forEach(({gain, smoothing_s}, i) => {
      gain.setTargetAtTime(
          this.settings.sound ? loudness[i] : 0, this.audio.currentTime, smoothing_s);
    });
  }
}
