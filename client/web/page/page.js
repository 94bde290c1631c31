// SPDX-License-Identifier: MIT
// The page of a stream: connects the worker, which receives the stream and renders the force, with
// the views, the input and the panel.

import {Feedback} from './feedback.js';
import {Film} from './film.js';
import {GamepadInput} from './gamepad.js';
import {Keys} from './keys.js';
import {makeOperatorControls, showAct} from './operator.js';
import * as panel from './panel.js';
import {find} from './panel.js';
import {ForcePlot} from './plot.js';
import {PointerInput} from './pointer.js';
import {keepSettings, loadSettings, readFragment} from './settings.js';
import {StatusTexts} from './status.js';
import {Target} from './target.js';
import {TimeBar} from './timeline.js';
import {Views} from './views.js';

const kWorkspace = ['width_px', 'height_px', 'width_mm', 'height_mm', 'depth_mm', 'stretch'];
const kTexts_ms = 100;  // texts change ten times a second
const kPlot_ms = 50;
const kLongestStep_s = 0.25;  // of held keys and sticks, while the page draws rarely

find('no-scripts').remove();

class Page {
  status = {state: 'loading', text: 'loading', share: 0};
  stream = null;
  ticks = null;  // last message of this kind
  drawn_ms = 0;
  texts_ms = 0;
  plot_ms = 0;
  eye_hand_ms = 0;

  constructor() {
    this.source = document.querySelector('meta[name=hapticast-source]').content;
    this.isRecording = this.source !== 'stream';
    this.settings = loadSettings();
    this.film = new Film();
    this.target = new Target();
    this.views = new Views(this.settings);
    this.plot = new ForcePlot(find('plot'));
    this.feedback = new Feedback(this.settings);
    this.texts = new StatusTexts();
    this.controls = new panel.ForceControls(message => this.send(message));
    this.timeBar = new TimeBar(control => this.control(control), () => this.act('pause'));
    const state = () => ({
      stream: this.stream,
      report: this.report,
      objects: this.film.shownReliefs?.objects ?? [],
    });
    this.gamepad = new GamepadInput(this.target, action => this.act(action));
    this.keys = new Keys(
        this.target, this.settings, state, action => this.act(action),
        (yaw, pitch) => this.views.turn(yaw, pitch));
    const {flat, relief} = this.views;
    new PointerInput(flat.element, flat.view, this.target, null, state);
    new PointerInput(relief.element, relief.view, this.target, this.views, state);
    makeOperatorControls(control => this.control(control));
    this.connectButtons();
    panel.fillHelp(this.isRecording);
    panel.connectSettings(this.settings, () => this.feedback.startSound());
  }

  get report() { return this.ticks?.report ?? null; }

  /// Starts the worker and opens the stream, or the recording beside the page.
  open() {
    this.stopWorker();
    const url = new URL(this.source, document.baseURI);
    url.hash = '';
    if (!this.isRecording) url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    const worker = new Worker('worker.js', {type: 'module'});
    worker.onmessage = ({data}) => this.receive(data);
    worker.onerror = event => {
      event.preventDefault();
      this.stopWorker();
      this.receive({
        type: 'status',
        state: 'failed',
        share: 0,
        text: 'The renderer of the page has stopped' +
            (event.message ? `: ${event.message}` : '.')
      });
    };
    this.worker = worker;
    this.send({
      type: 'open',
      source: this.isRecording ? 'recording' : 'stream',
      url: url.href,
      ...readFragment()
    });
    this.controls.update();
    this.askForViews();
  }

  /// Ends the worker. No force of it stays on the screen.
  stopWorker() {
    this.worker?.terminate();
    this.worker = null;
    this.ticks = null;
    this.texts.showForce({force_N: [0, 0, 0], penetration_mm: 0, halted: false});
  }

  /// The worker sends reliefs only while the page shows them, and the server sends no pictures to a
  /// hidden page.
  askForViews() {
    this.send({type: 'show', reliefs: this.views.showsRelief, pictures: !document.hidden});
  }

  send(message) { this.worker?.postMessage(message); }

  control(control) { this.send({type: 'control', control}); }

  receive(message) {
    switch (message.type) {
      case 'status':
        this.status = message;
        this.texts.showStatus(message);
        break;
      case 'stream':
        this.setStream(message);
        break;
      case 'picture':
        this.film.addPicture(message.media_ms, message.jpeg);
        break;
      case 'reliefs':
        this.film.addReliefs(message.media_ms, message.objects);
        break;
      case 'ticks':
        this.ticks = message;
        this.endPreparation();
        this.plot.add(message.history);
        this.feedback.add(message.report, message.history);
        break;
    }
  }

  /// The first frames end the preparation.
  endPreparation() {
    const isOver =
        this.status.state === 'preparing' && !['none', 'faded'].includes(this.report.lookup);
    if (isOver) this.receive({type: 'status', state: 'connected', text: '', share: 1});
  }

  setStream(stream) {
    const isOther = kWorkspace.some(name => stream[name] !== this.stream?.[name]);
    this.stream = stream;
    if (isOther) {
      this.film.clear();
      this.views.setStream(stream);
      this.target.setStream(stream);
    }
    this.texts.showStream(stream);
    this.timeBar.setTimeline(stream.timeline);
    find('operator').hidden = !stream.operator || stream.timeline !== null;
  }

  connectButtons() {
    find('view-button').addEventListener('click', () => this.act('view'));
    find('help-button').addEventListener('click', () => this.act('help'));
    find('panel-button').addEventListener('click', () => this.act('panel'));
    find('lift').addEventListener('click', () => this.act('lift'));
    find('rearm').addEventListener('click', () => this.act('rearm'));
    find('pause').addEventListener('change', ({target}) => this.setPaused(target.checked));
    this.showPanel(this.settings.panel ?? innerWidth >= 900);
    this.connectPress(find('press'));
    document.addEventListener('visibilitychange', () => this.askForViews());
    for (const name of ['pointerdown', 'keydown'])
      addEventListener(name, () => this.feedback.startSound(), {capture: true});
  }

  /// The tip presses while the button is held, by a pointer or by a key.
  connectPress(button) {
    const hold = isHeld => {
      button.classList.toggle('held', isHeld);
      if (isHeld)
        this.target.isPressing = true;
      else
        this.target.lift();
    };
    button.addEventListener('pointerdown', event => {
      button.setPointerCapture(event.pointerId);
      hold(true);
    });
    for (const name of ['pointerup', 'pointercancel'])
      button.addEventListener(name, () => hold(false));
    button.addEventListener('keydown', event => {
      if ((event.key === ' ' || event.key === 'Enter') && !event.repeat) hold(true);
    });
    button.addEventListener('keyup', event => {
      if (event.key === ' ' || event.key === 'Enter') hold(false);
    });
    button.addEventListener('blur', () => {
      if (button.classList.contains('held')) hold(false);
    });
    button.addEventListener('contextmenu', event => event.preventDefault());
  }

  showPanel(isOpen) {
    find('panel').hidden = !isOpen;
    find('panel-button').setAttribute('aria-expanded', String(isOpen));
    this.plot.changed = true;
  }

  /// Pauses play time, and the recording where this viewer has a time line.
  setPaused(paused) {
    this.controls.paused = paused;
    if (this.stream?.timeline) this.control({paused});
  }

  /// Carries out an action of a key or of a button.
  act(action) {
    switch (action) {
      case 'pause':
        this.setPaused(!this.controls.paused);
        break;
      case 'lift':
        this.target.lift();
        break;
      case 'static':
      case 'dynamic':
        this.controls.flip(action);
        break;
      case 'rearm':
        this.send({type: 'rearm'});
        break;
      case 'view':
        this.settings.view = this.views.chooseNext();
        keepSettings(this.settings);
        this.askForViews();
        break;
      case 'help':
        if (find('help').open)
          find('help').close();
        else
          find('help').showModal();
        break;
      case 'panel':
        this.settings.panel = find('panel').hidden;
        this.showPanel(this.settings.panel);
        keepSettings(this.settings);
        break;
      default:
        this.timeBar.act(action, this.report?.play_ms ?? 0);
    }
  }

  /// Moves the target, and draws what has changed.
  draw(now_ms) {
    requestAnimationFrame(time_ms => this.draw(time_ms));
    const dt_s = Math.min((now_ms - this.drawn_ms) / 1000, kLongestStep_s);
    this.drawn_ms = now_ms;
    this.moveTarget(dt_s);
    const report = this.report;
    const isPlaying = report && report.lookup !== 'none';
    const changed = this.film.select(isPlaying ? report.play_ms : null);
    if (isPlaying && this.film.shownPicture)
      this.eye_hand_ms = this.film.shownPicture.media_ms - report.play_ms;
    this.views.draw(this.film, changed, isPlaying ? {report, target: this.target} : null);
    if (this.ticks && now_ms - this.texts_ms >= kTexts_ms) {
      this.texts_ms = now_ms;
      this.showTexts(report);
    }
    if (now_ms - this.plot_ms >= kPlot_ms) {
      this.plot_ms = now_ms;
      this.plot.draw();
    }
  }

  moveTarget(dt_s) {
    const {target, report} = this;
    if (target.start_mm === null) return;
    this.keys.advance(dt_s);
    this.gamepad.advance(dt_s, report);
    target.advance(dt_s, report);
    if (!target.changed) return;
    target.changed = false;
    this.send({type: 'pointer', x_mm: target.x_mm, y_mm: target.y_mm, z_mm: target.z_mm});
  }

  showTexts(report) {
    if (this.status.state === 'connected')
      this.texts.showTicks(this.ticks, matchMedia('(pointer: coarse)').matches);
    else
      this.texts.showForce(report);
    this.timeBar.show(report.play_ms, this.controls.paused);
    showAct(this.stream?.act, this.ticks.stats.media_now_ms);
    panel.showFacts(this.stream, report, this.ticks.stats, this.stats);
  }

  get stats() {
    return {
      ...this.ticks?.stats,
      ...this.views.drawings,
      pictures_shown: this.film.shown,
      eye_hand_ms: this.eye_hand_ms,
      decode_ms: this.film.decode_ms,
      view: this.views.mode,
      relief_problem: this.views.problem,
      target_mm: [this.target.x_mm, this.target.y_mm, this.target.z_mm],
    };
  }
}

const page = new Page();
// For tests: read only.
class TestAccess {
  get report() { return page.report; }
  get stats() { return page.stats; }
  get stream() { return page.stream; }
  get status() { return page.status; }
}
Object.defineProperty(window, 'hapticast', {value: Object.freeze(new TestAccess())});
page.open();
requestAnimationFrame(time_ms => page.draw(time_ms));
// Another link into the same tab: only its fragment differs, and the browser loads nothing.
addEventListener('hashchange', () => page.open());
setInterval(panel.noteAbilities, 2000);
