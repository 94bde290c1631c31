// SPDX-License-Identifier: MIT
// The target of the tip. Pointer, touch, pen, keys and gamepad move it; the worker leads the tip
// there. It starts above the highest possible relief and goes down to a little behind the picture.

import {clamp, computeScale, norm} from './geometry.js';

const kAboveRelief_mm = 5;  // as in the native window
const kFarthest_mm = -5;
const kMostAhead_mm = 10;  // of keys and gamepad: a press of 2 N, and no longer way back
const kFirm_N = 1;         // a held press stops here
const kMostPress_mm = 12;  // and at most so far below the surface
const kPen_mm = 16;        // depth of a pen's full pressure: 3 N on a hand of 0.2 N/mm
const kPenAbove_mm = 2;    // without pressure
const kNear_mm = 3;        // a pen presses when the tip has come below it
const kSlowest_mm_s = 8, kFastest_mm_s = 60, kApproach_1_s = 4;

export class Target {
  x_mm = 0;
  y_mm = 0;
  z_mm = 0;
  start_mm = null;     // null before the first description
  isPressing = false;  // a finger rests, or the button is held
  pressure = null;     // of a pen, 0..1
  changed = false;

  /// Sets the limits of a stream. The first call, and another depth, place the target at the start.
  setStream(stream) {
    const [sx, sy] = computeScale(stream);
    this.mostX_mm = stream.width_px * sx / 2;
    this.mostY_mm = stream.height_px * sy / 2;
    const start_mm = stream.depth_mm + kAboveRelief_mm;
    if (start_mm === this.start_mm) return;
    this.start_mm = start_mm;
    this.lift();
  }

  moveTo(x_mm, y_mm) {
    if (this.start_mm === null) return;
    this.x_mm = clamp(x_mm, -this.mostX_mm, this.mostX_mm);
    this.y_mm = clamp(y_mm, -this.mostY_mm, this.mostY_mm);
    this.changed = true;
  }

  /// Moves into the picture, or out of it if the value is negative.
  press(by_mm) {
    if (Number.isFinite(by_mm)) this.setDepth(this.z_mm - by_mm);
  }

  setDepth(z_mm) {
    if (this.start_mm === null) return;
    this.z_mm = clamp(z_mm, kFarthest_mm, this.start_mm);
    this.changed = true;
  }

  lift() {
    this.isPressing = false;
    this.pressure = null;
    this.setDepth(this.start_mm);
  }

  /// Moves by a step of keys or of a stick. The target stays near the tip: an obstacle causes no
  /// wind-up.
  lead(dx_mm, dy_mm, dz_mm, report) {
    this.moveTo(this.x_mm + dx_mm, this.y_mm + dy_mm);
    this.press(-dz_mm);
    if (!report || report.lookup === 'none') return;
    const tip_mm = report.hip_mm;
    const ahead_mm = [this.x_mm - tip_mm[0], this.y_mm - tip_mm[1], this.z_mm - tip_mm[2]];
    const factor = kMostAhead_mm / norm(ahead_mm);
    if (factor >= 1) return;
    this.moveTo(tip_mm[0] + factor * ahead_mm[0], tip_mm[1] + factor * ahead_mm[1]);
    this.setDepth(tip_mm[2] + factor * ahead_mm[2]);
  }

  /// Continues a held press, and follows the pressure of a pen.
  advance(dt_s, report) {
    if (!report) return;
    const surface_mm = report.over_object ? report.height_at_hip_mm : 0;
    if (this.pressure !== null)
      this.followPen(surface_mm, report);
    else if (this.isPressing)
      this.continuePress(dt_s, surface_mm, report);
  }

  /// The pressure is the depth below the surface, so that a light press touches everywhere.
  followPen(surface_mm, report) {
    const away_mm = Math.hypot(this.x_mm - report.hip_mm[0], this.y_mm - report.hip_mm[1]);
    if (away_mm < kNear_mm || report.contact)
      this.setDepth(surface_mm + kPenAbove_mm - kPen_mm * this.pressure);
  }

  /// Moves fast in free air and slowly near the surface, until the press is firm.
  continuePress(dt_s, surface_mm, report) {
    if (report.contact && norm(report.force_N) >= kFirm_N) return;
    if (report.contact && this.z_mm < report.contact_mm[2] - kMostPress_mm) return;
    const speed_mm_s =
        clamp(kApproach_1_s * (this.z_mm - surface_mm), kSlowest_mm_s, kFastest_mm_s);
    this.press(speed_mm_s * dt_s);
  }
}
