// SPDX-License-Identifier: MIT
// Mouse, touch and pen over a view.
// Mouse: a move moves the tip, the wheel presses and lifts, a drag down presses and up lifts. The
// second button turns the relief. Touch: one finger moves; a resting finger presses until it is
// lifted; two fingers pinch to press, and turn the relief. Pen: its pressure is the depth.

const kNotch_px = 100;  // of a wheel's event in px; in lines: 3
const kNotch_mm = 1;    // as in the native window
const kDrag_mm_per_px = 0.1;
const kPinch_mm_per_px = 0.15;
const kTurn_rad_per_px = 0.01;
const kRest_ms = 250;  // chosen: shorter than a browser's long press
const kRest_px = 8;    // a finger that moves less rests

/// Connects the events of `element` with `target`. `view` picks positions, `camera` is turned or
/// null. `state()` returns {stream, objects, report}.
export class PointerInput {
  constructor(element, view, target, camera, state) {
    Object.assign(this, {element, view, target, camera, state});
    this.fingers = new Map();
    this.drag = null;      // 'press' or 'turn'
    this.last = null;      // place of the cursor before, px
    this.offset = [0, 0];  // from the cursor to the target after a drag, px
    const listen = (name, action, options) => element.addEventListener(name, event => {
      if (state().stream) action.call(this, event);
    }, options);
    listen('pointermove', this.move);
    listen('pointerdown', this.down);
    for (const name of ['pointerup', 'pointercancel']) listen(name, this.up);
    listen('pointerleave', () => {
      if (this.drag) return;
      this.offset = [0, 0];
      this.last = null;
    });
    listen('wheel', this.wheel, {passive: false});
    listen('contextmenu', event => event.preventDefault());
  }

  place(event) {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /// Moves the tip to a point. Returns false beside the picture.
  point([x, y]) {
    const {stream, objects} = this.state();
    if (!this.view.zoom) return false;  // before the first drawing
    const at_mm = this.view.pick(x + this.offset[0], y + this.offset[1], stream, objects);
    if (at_mm) this.target.moveTo(...at_mm);
    return at_mm !== null;
  }

  wheel(event) {
    if (event.ctrlKey) return;  // the browser's zoom
    event.preventDefault();
    const notches = event.deltaMode === 0 ? event.deltaY / kNotch_px : event.deltaY / 3;
    const natural = event.webkitDirectionInvertedFromDevice ? -1 : 1;
    this.target.press(natural * notches * kNotch_mm);
  }

  down(event) {
    this.element.setPointerCapture?.(event.pointerId);
    this.last = this.place(event);
    if (event.pointerType === 'touch') return this.touchDown(event);
    if (event.button === 2) this.drag = 'turn';
    if (event.button !== 0) return;
    if (event.pointerType === 'pen') return this.pen(event);
    this.drag = this.point(this.last) ? 'press' : 'turn';
  }

  move(event) {
    if (event.pointerType === 'touch') return this.touchMove(event);
    if (event.pointerType === 'pen' && event.buttons & 1) return this.pen(event);
    const at = this.place(event);
    const [dx, dy] = this.last ? [at[0] - this.last[0], at[1] - this.last[1]] : [0, 0];
    this.last = at;
    if (this.drag === 'turn') return this.turn(dx, dy);
    if (this.drag === 'press') {
      this.target.press(kDrag_mm_per_px * dy);
      this.offset = [this.offset[0] - dx, this.offset[1] - dy];
      return;
    }
    this.returnToCursor(Math.hypot(dx, dy));
    this.point(at);
  }

  /// After a drag the cursor is away from the target. Each move brings both nearer, without a jump.
  returnToCursor(by_px) {
    const length = Math.hypot(...this.offset);
    const factor = length > by_px ? 1 - 0.5 * by_px / length : 0;
    this.offset = this.offset.map(part => factor * part);
  }

  up(event) {
    if (event.pointerType === 'touch') return this.touchUp(event);
    if (event.pointerType === 'pen' && event.button <= 0) this.target.lift();
    this.drag = null;
  }

  turn(dx, dy) { this.camera?.turn(kTurn_rad_per_px * dx, -kTurn_rad_per_px * dy); }

  pen(event) {
    this.point(this.place(event));
    this.target.pressure = event.pressure;
  }

  touchDown(event) {
    const at = this.place(event);
    this.fingers.set(event.pointerId, at);
    if (this.fingers.size > 1) {
      clearTimeout(this.resting);
      this.target.isPressing = false;
      return;
    }
    // A finger beside the picture turns the relief.
    this.drag = this.point(at) ? null : 'turn';
    if (!this.drag) this.rest(at);
  }

  /// Begins to press when the finger has rested at `at` for a moment.
  rest(at) {
    this.restedAt = at;
    clearTimeout(this.resting);
    this.resting = setTimeout(() => {
      if (this.fingers.size === 1) this.target.isPressing = true;
    }, kRest_ms);
  }

  touchMove(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const at = this.place(event);
    if (this.fingers.size > 1) {
      this.pinch(event.pointerId, before, at);
    } else if (this.drag) {
      this.turn(at[0] - before[0], at[1] - before[1]);
    } else {
      this.point(at);
      const moved_px = Math.hypot(at[0] - this.restedAt[0], at[1] - this.restedAt[1]);
      if (!this.target.isPressing && moved_px > kRest_px) this.rest(at);
    }
    this.fingers.set(event.pointerId, at);
  }

  pinch(id, before, at) {
    const [other] = [...this.fingers].find(([key]) => key !== id).slice(1);
    const span = point => Math.hypot(point[0] - other[0], point[1] - other[1]);
    this.target.press(kPinch_mm_per_px * (span(before) - span(at)));
    this.turn((at[0] - before[0]) / 2, (at[1] - before[1]) / 2);
  }

  touchUp(event) {
    if (!this.fingers.delete(event.pointerId) || this.fingers.size > 0) return;
    clearTimeout(this.resting);
    this.drag = null;
    this.target.lift();
  }
}
