// SPDX-License-Identifier: MIT
// Controls of an operator: time and material of the stream, for all viewers.

import {find, make, setText} from './panel.js';
import {fillSpeeds} from './timeline.js';

// Name in the message, text, ends and step of the slider, value at the start. Chosen: the useful
// part of what the protocol permits.
const kMaterial = [
  ['stiffness_N_mm', 'stiffness, N/mm', 0, 3, 0.01, 0.5],
  ['damping_Ns_m', 'damping, Ns/m', 0, 5, 0.05, 0],
  ['static_friction', 'static friction', 0, 1.5, 0.01, 0.3],
  ['dynamic_friction', 'dynamic friction', 0, 1.5, 0.01, 0.2],
  ['texture_K_mm', 'texture depth, mm', 0, 5, 0.05, 1],
  ['mass_kg', 'mass, kg', 0.01, 2, 0.01, 0.1],
];

/// Returns who did what and how long ago, in one line.
function describeAct({name, at_ms, paused, seek_s, speed, material}, media_ms) {
  const acts = [];
  if (!Number.isNaN(paused)) acts.push(paused ? 'paused' : 'played');
  if (!Number.isNaN(seek_s)) acts.push(`went to ${seek_s.toFixed(1)} s`);
  if (!Number.isNaN(speed)) acts.push(`set the speed x ${speed}`);
  if (!Number.isNaN(material)) acts.push('changed the material');
  const age_s = Math.max(0, Math.floor((media_ms - at_ms) / 1000));
  const age = age_s < 60 ? `${age_s} s` : `${Math.floor(age_s / 60)} min`;
  return `${name || 'another operator'} ${acts.join(', ')}, ${age} ago`;
}

/// Shows the last act of another operator, or nothing. `media_ms`: the media time now.
export function showAct(act, media_ms) {
  find('operator-act').hidden = !act;
  if (act) setText(find('operator-act'), describeAct(act, media_ms));
}

/// Makes the controls. `control(request)` sends a request to the server.
export function makeOperatorControls(control) {
  find('operator-pause').addEventListener('click', () => control({paused: true}));
  find('operator-play').addEventListener('click', () => control({paused: false}));
  find('operator-seek').addEventListener('change', () => {
    const seek_s = find('operator-seek').valueAsNumber;
    if (seek_s >= 0) control({seek_s});
  });
  fillSpeeds(find('operator-speed'));
  find('operator-speed').addEventListener('change', () => control({
                                                      speed: Number(find('operator-speed').value)
                                                    }));
  for (const [name, text, min, max, step, value] of kMaterial) {
    const output = make('output', {textContent: "author's"});
    const slider = make('input', {type: 'range', id: `material-${name}`, min, max, step, value});
    slider.addEventListener('input', () => setText(output, Number(slider.value).toFixed(2)));
    slider.addEventListener('change', () => control({material: {[name]: Number(slider.value)}}));
    find('material').append(make('label', {className: 'slider'}, text + ' ', output, slider));
  }
}
