// SPDX-License-Identifier: MIT
// The time bar of a recording on demand: pause, place, speed.

import {clamp} from './geometry.js';
import {find, make, setText} from './panel.js';

const kStep_s = 5;  // of a key; usual in video players
const kSpeeds = [0.1, 0.25, 0.5, 1, 1.5, 2, 4];

const formatPlace = time_s =>
    `${Math.floor(time_s / 60)}:${String(Math.floor(time_s % 60)).padStart(2, '0')}`;

/// Fills a selection with the speeds.
export function fillSpeeds(select) {
  for (const speed of kSpeeds)
    select.append(make('option', {value: String(speed), textContent: `x ${speed}`}));
  select.value = '1';
}

export class TimeBar {
  timeline = null;
  isDragged = false;
  speed = 1;
  wanted_s = null;  // a place that the server has not reached yet

  /// `control(request)` sends a request to the server, `pause()` switches the pause.
  constructor(control, pause) {
    this.control = control;
    fillSpeeds(find('speed'));
    find('speed').addEventListener('change', () => this.setSpeed(Number(find('speed').value)));
    find('pause-button').addEventListener('click', pause);
    find('place').addEventListener('input', () => {
      this.isDragged = true;
      this.showPlace(Number(find('place').value));
    });
    find('place').addEventListener('change', () => {
      this.isDragged = false;
      this.seek(Number(find('place').value));
    });
  }

  setTimeline(timeline) {
    find('time').hidden = !timeline;
    if (!timeline) this.timeline = null;
    if (!timeline || JSON.stringify(timeline) === JSON.stringify(this.timeline)) return;
    this.timeline = timeline;
    this.wanted_s = null;
    find('place').max = timeline.length_s;
    if (timeline.speed > 0) this.speed = timeline.speed;
    if (kSpeeds.includes(this.speed)) find('speed').value = String(this.speed);
  }

  computePlace_s(play_ms) {
    const {length_s, position_s, at_ms, speed} = this.timeline;
    return clamp(position_s + speed * (play_ms - at_ms) / 1000, 0, length_s);
  }

  /// Carries out 'back', 'ahead', 'faster' or 'slower'.
  act(action, play_ms) {
    if (!this.timeline) return;
    const from_s = this.wanted_s ?? this.computePlace_s(play_ms);
    if (action === 'back') this.seek(from_s - kStep_s);
    if (action === 'ahead') this.seek(from_s + kStep_s);
    const nearest = kSpeeds.reduce(
        (best, speed, i) =>
            Math.abs(speed - this.speed) < Math.abs(kSpeeds[best] - this.speed) ? i : best,
        0);
    if (action === 'faster') this.setSpeed(kSpeeds[Math.min(nearest + 1, kSpeeds.length - 1)]);
    if (action === 'slower') this.setSpeed(kSpeeds[Math.max(nearest - 1, 0)]);
  }

  seek(place_s) {
    this.wanted_s = clamp(place_s, 0, this.timeline.length_s);
    this.control({seek_s: this.wanted_s});
  }

  setSpeed(speed) {
    this.speed = speed;
    find('speed').value = String(speed);
    this.control({speed});
  }

  showPlace(place_s) {
    const text = `${formatPlace(place_s)} / ${formatPlace(this.timeline.length_s)}`;
    const ended = this.timeline.speed === 0 && place_s >= this.timeline.length_s;
    setText(find('place-text'), ended ? text + ', the end' : text);
    find('place').setAttribute('aria-valuetext', text.replace('/', 'of'));
  }

  /// Shows the place of play time.
  show(play_ms, paused) {
    if (!this.timeline) return;
    setText(find('pause-button'), paused ? 'play' : 'pause');
    if (this.isDragged) return;
    const place_s = this.wanted_s ?? this.computePlace_s(play_ms);
    find('place').value = place_s;
    this.showPlace(place_s);
  }
}
