// SPDX-License-Identifier: MIT
// The panel: controls of the force, feedback of the browser, legend, facts of the stream.

import {findAbilities} from './feedback.js';
import {kHelp} from './keys.js';
import {kColours} from './overlay.js';
import {keepSettings} from './settings.js';

export const find = id => document.getElementById(id);

/// Sets a text only if it changes: an equal text costs a layout, too.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

// The legend of the native window.
const kLegend = [
  ['force', 'yellow arrow: force at the device'],
  ['static', 'blue, dashed: its static share'],
  ['dynamic', 'red, dashed: its dynamic share'],
  ['contact', 'green ring: contact'],
  ['cone', 'cone: its tip touches the object'],
  ['gap', 'line: height above the object'],
  ['pointer', 'white ring: pointer'],
];

function drawMark(canvas, mark) {
  const g = canvas.getContext('2d');
  g.scale(2, 2);
  g.strokeStyle = g.fillStyle = kColours[mark] ?? '#fff';
  g.lineWidth = mark === 'force' ? 4 : 2;
  g.beginPath();
  if (mark === 'contact' || mark === 'pointer') {
    g.arc(15, 8, 5, 0, 2 * Math.PI);
  } else if (mark === 'cone') {
    for (const [x, y] of [[9, 13], [16, 2], [22, 7]]) g.lineTo(x, y);
    return g.fill();
  } else {
    if (mark === 'static' || mark === 'dynamic') g.setLineDash([5, 3]);
    g.moveTo(3, 8);
    g.lineTo(mark === 'gap' ? 27 : 20, 8);
  }
  g.stroke();
  if (!['force', 'static', 'dynamic'].includes(mark)) return;
  g.beginPath();
  for (const [x, y] of [[27, 8], [19, 3], [19, 13]]) g.lineTo(x, y);
  g.fill();
}

function fillLegend(list) {
  for (const [mark, text] of kLegend) {
    const canvas = make('canvas', {className: 'mark', width: 60, height: 32});
    canvas.setAttribute('aria-hidden', 'true');
    drawMark(canvas, mark);
    list.append(make('li', {}, canvas, text));
  }
}

/// Fills the help, the legends and the command of the native client.
export function fillHelp(isRecording) {
  for (const [key, does] of kHelp)
    find('help-keys').append(make('dt', {textContent: key}), make('dd', {textContent: does}));
  fillLegend(find('legend'));
  fillLegend(find('help-legend'));
  const port = location.port || (location.protocol === 'https:' ? '443' : '80');
  const scheme = location.protocol === 'https:' ? 'hapticasts://' : '';
  const command =
      'hapticast-client ' + (isRecording ? 'HOST:PORT' : `${scheme}${location.hostname}:${port}`);
  for (const code of document.querySelectorAll('.command')) code.textContent = command;
}

const kSliders = ['factor', 'stiffness', 'friction'];
const kForceControls = ['static', 'dynamic', 'authors-friction', ...kSliders];

/// The user's controls of the force. `send(message)` receives the message 'user' after each change.
export class ForceControls {
  constructor(send) {
    this.send = send;
    for (const id of kForceControls) find(id).addEventListener('input', () => this.update());
  }

  flip(id) {
    find(id).checked = !find(id).checked;
    this.update();
  }

  get paused() { return find('pause').checked; }

  set paused(value) {
    find('pause').checked = value;
    this.update();
  }

  update() {
    for (const id of kSliders) setText(find(id + '-text'), Number(find(id).value).toFixed(2));
    const authors = find('authors-friction').checked;
    find('friction').disabled = authors;
    this.send({
      type: 'user',
      paused: find('pause').checked,
      staticOn: find('static').checked,
      dynamicOn: find('dynamic').checked,
      stiffnessFactor: Number(find('stiffness').value),
      forceFactor: Number(find('factor').value),
      friction: authors ? null : Number(find('friction').value),
    });
  }
}

const kNever = ' Never tried on hardware.';

function describeRumble(has) {
  if (!navigator.getGamepads)
    return 'This browser gives this page no gamepads: they need https or localhost.';
  if (has.pad) return 'This browser and this gamepad have it.' + kNever;
  if (has.rumble)
    return 'This browser has it. Press a button of a gamepad that can rumble.' + kNever;
  return 'This browser has no rumble of gamepads.' + kNever;
}

function describeSound(has) {
  if (!has.sound) return 'This browser has no Web Audio.';
  return 'This browser has it: a low tone for the press, a high tone for a sudden force.' + kNever;
}

function describeVibration(has) {
  if (!has.vibration) return 'This browser has no vibration. iPhones have none.';
  return 'This browser has it. Only phones have the motor.' + kNever;
}

/// Says what this browser has.
export function noteAbilities() {
  const has = findAbilities();
  setText(find('sound-note'), describeSound(has));
  setText(find('rumble-note'), describeRumble(has));
  setText(find('vibration-note'), describeVibration(has));
  find('sound').disabled = !has.sound;
  find('rumble').disabled = !has.rumble;
  find('vibration').disabled = !has.vibration;
}

/// Connects the switches with the settings. `changed()` follows each change.
export function connectSettings(settings, changed) {
  for (const name of ['sound', 'rumble', 'vibration', 'letters']) {
    find(name).checked = settings[name];
    find(name).addEventListener('change', () => {
      settings[name] = find(name).checked;
      keepSettings(settings);
      changed();
    });
  }
  noteAbilities();
  for (const event of ['gamepadconnected', 'gamepaddisconnected'])
    addEventListener(event, noteAbilities);
}

/// Writes the facts of the stream, if their section is open.
export function showFacts(stream, report, stats, page) {
  const list = find('stream-facts');
  if (!stream || !list.parentElement.open) return;
  const facts = {
    source: stream.name,
    picture: `${stream.width_px} x ${stream.height_px} px, ${stream.fps} a second`,
    workspace: `${stream.width_mm} x ${stream.height_mm} x ${stream.depth_mm} mm`,
    signature: stream.key ? `${stream.signature}, key ${stream.key}` : stream.signature,
    delay: report ? `behind by ${report.playout_delay_ms.toFixed(0)} ms` : '',
    frames: `${stats.frames_received}, ${stats.frames_lost} lost, ${stats.frames_late} late`,
    ticks: `${stats.ticks}, ${stats.late} late, ${stats.tick_us?.toFixed(1)} µs each`,
    tip: report ? report.hip_mm.map(at => at.toFixed(1)).join(', ') + ' mm' : '',
    pictures: `${page.pictures_shown} shown, eye - hand ${page.eye_hand_ms.toFixed(0)} ms`,
  };
  if (list.childElementCount === 0)
    for (const name of Object.keys(facts)) list.append(make('dt', {textContent: name}), make('dd'));
  Object.values(facts).forEach((text, i) => setText(list.children[2 * i + 1], text));
}
