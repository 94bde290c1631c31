// SPDX-License-Identifier: MIT
// A gamepad as an input, as in the native client. The left stick moves the tip. The right stick
// forward presses, back lifts. The right trigger presses, the left one lifts.

const kDeadZone = 0.24;  // XInput's dead zone of a left stick
const kAcross_mm_s = 80, kInto_mm_s = 30;
const kRearm = 0, kPause = 9;  // A and Start of the standard mapping
const kLeftTrigger = 6, kRightTrigger = 7;
const kSearch_s = 0.25;  // without a gamepad the page looks less often

/// Returns the deflection without the dead zone: its square, for fine movements.
export function shapeDeflection(x, y) {
  const deflection = Math.hypot(x, y);
  if (!(deflection > kDeadZone)) return [0, 0];
  const beyond = Math.min(1, (deflection - kDeadZone) / (1 - kDeadZone));
  return [beyond * beyond / deflection * x, beyond * beyond / deflection * y];
}

/// Returns the first gamepad; null if there is none, or if the browser has none.
export function findPad() {
  return navigator.getGamepads?.().find?.(pad => pad?.connected) ?? null;
}

export class GamepadInput {
  pad = null;
  wait_s = 0;
  pressed = new Set();

  constructor(target, act) { Object.assign(this, {target, act}); }

  /// Reads the gamepad and moves the tip.
  advance(dt_s, report) {
    this.wait_s -= dt_s;
    if (!this.pad && this.wait_s > 0) return;
    this.wait_s = kSearch_s;
    this.pad = findPad();
    if (!this.pad) return;
    const {axes, buttons} = this.pad;
    const [x, y] = shapeDeflection(axes[0] ?? 0, axes[1] ?? 0);
    const [, back] = shapeDeflection(0, axes[3] ?? 0);
    const trigger = i => buttons[i]?.value ?? 0;
    const out = back + trigger(kLeftTrigger) - trigger(kRightTrigger);
    if (x || y || out)
      this.target.lead(
          kAcross_mm_s * dt_s * x, -kAcross_mm_s * dt_s * y, kInto_mm_s * dt_s * out, report);
    this.readButton(kRearm, 'rearm');
    this.readButton(kPause, 'pause');
  }

  readButton(index, action) {
    const isDown = this.pad.buttons[index]?.pressed ?? false;
    if (isDown && !this.pressed.has(index)) this.act(action);
    if (isDown)
      this.pressed.add(index);
    else
      this.pressed.delete(index);
  }
}
