// SPDX-License-Identifier: MIT
// Keys of the page. Those that the native window has mean the same here.
// A held key moves the tip: one step at once, then steadily. A recording uses the arrows left and
// right and the page keys for its time, so letters move the tip as well.

const kStep_mm = 1;
const kDelay_s = 0.2;  // until a held key moves steadily
const kAcross_mm_s = 60, kInto_mm_s = 25;
const kTurn_rad = Math.PI / 36;

const kMoves = {
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  t: [0, 1, 0],
  g: [0, -1, 0],
  f: [-1, 0, 0],
  h: [1, 0, 0],
  PageDown: [0, 0, -1],
  c: [0, 0, -1],
  PageUp: [0, 0, 1],
  e: [0, 0, 1],
};
const kTurns = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1]
};
const kOfTimeline = {
  ArrowLeft: 'back',
  ArrowRight: 'ahead',
  PageUp: 'faster',
  PageDown: 'slower',
};
const kActions = {
  ' ': 'pause',
  Home: 'lift',
  s: 'static',
  d: 'dynamic',
  r: 'rearm',
  v: 'view',
  F1: 'help',
  '?': 'help',
  F2: 'panel',
};

/// Rows of the help: key, what it does.
export const kHelp = [
  ['pointer', 'moves the tip over the picture'],
  ['wheel down, drag down', 'moves the tip into the picture: presses'],
  ['wheel up, drag up', 'moves the tip out of the picture: lifts'],
  ['finger', 'moves the tip; a resting finger presses'],
  ['two fingers', 'together: presses; apart: lifts; side by side: turn the relief'],
  ['pen', 'its pressure is the depth'],
  ['T, F, G, H or arrows', 'move the tip up, left, down, right'],
  ['C, E or page down, up', 'press, lift'],
  ['Home', 'brings the tip back above the picture'],
  ['space', 'pauses and resumes time'],
  ['left, right', '5 s back, ahead (a recording on demand)'],
  ['page up, down', 'faster, slower (a recording on demand)'],
  ['S, D', 'static, dynamic force on and off'],
  ['R', 're-arms the force'],
  ['V', 'the picture; again: the relief; again: both'],
  ['Shift and arrows, second button', 'turn the relief'],
  [
    'gamepad',
    'left stick: moves; right stick forward or right trigger: presses; A: re-arms; Start: pauses'
  ],
  ['F1 or ?', 'this help'],
  ['F2', 'folds and unfolds the panel'],
];

/// Elements that use keys themselves.
function usesKey(element, key) {
  if (element.matches('input[type=number], select')) return true;
  if (element.matches('input[type=range]')) return /^(Arrow|Page|Home)/.test(key);
  if (element.matches('button, summary, a, input')) return key === ' ';
  return element.closest('#panel') !== null && /^(Arrow|Page|Home)/.test(key);  // scrolls
}

export class Keys {
  held = new Map();  // key -> seconds until it moves steadily

  /// `act(name)` carries out an action, `turn(yaw, pitch)` turns the relief, `settings.letters`
  /// permits keys of one letter, `state()` returns {stream, report}.
  constructor(target, settings, state, act, turn) {
    Object.assign(this, {target, settings, state, act, turn});
    addEventListener('keydown', event => this.down(event));
    addEventListener('keyup', event => this.release(event.key));
    addEventListener('blur', () => this.held.clear());
  }

  down(event) {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (document.querySelector('dialog[open]') && key !== 'F1') return;
    if (usesKey(event.target, key) || (/^[a-z?]$/.test(key) && !this.settings.letters)) return;
    if (this.carryOut(key, event)) event.preventDefault();
  }

  carryOut(key, event) {
    if (event.shiftKey && kTurns[key]) {
      this.turn(...kTurns[key].map(part => part * kTurn_rad));
      return true;
    }
    const action = (this.state().stream?.timeline && kOfTimeline[key]) || kActions[key];
    if (action) {
      if (!event.repeat) this.act(action);
      return true;
    }
    if (!kMoves[key]) return false;
    if (!event.repeat && !this.held.has(key)) {
      this.held.set(key, kDelay_s);
      this.move(key, kStep_mm, kStep_mm);
    }
    return true;
  }

  release(key) { this.held.delete(key.length === 1 ? key.toLowerCase() : key); }

  move(key, across_mm, into_mm) {
    const [x, y, z] = kMoves[key];
    this.target.lead(x * across_mm, y * across_mm, z * into_mm, this.state().report);
  }

  /// Moves the tip by the held keys.
  advance(dt_s) {
    for (const [key, wait_s] of this.held) {
      this.held.set(key, wait_s - dt_s);
      if (wait_s <= 0) this.move(key, kAcross_mm_s * dt_s, kInto_mm_s * dt_s);
    }
  }
}
