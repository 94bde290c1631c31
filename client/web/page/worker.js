// SPDX-License-Identifier: MIT
// The worker of the page: a WebSocket around the session of the core (ClientSession), and a tick for
// each millisecond. A timer of a page is late by some milliseconds, so each call renders the ticks
// that are due, 20 at most. Frames are prepared between the ticks, one in each call. The page sends
// `open`, `pointer`, `user`, `rearm`, `control` and `show`; it receives `status`, `stream`,
// `picture`, `reliefs` and `ticks`.
import {startCore} from './core.js';
import {PlayerLink} from './player_link.js';

const kMostTicks = 20;       // in one call; a longer gap is a late tick, and its ticks are left out
const kReportEvery_ms = 16;  // chosen: once for each picture of a screen
const kAskEvery_ms = 2000;   // chosen: an operator sees viewers come and go
const kLateWithin_ms = 10_000;  // chosen, with kManyLate: a page that is often late, not once
const kManyLate = 10;
const kMostSamples = 96;  // along a side of a relief; chosen: a screen shows no more of an object

const now_ms = () => performance.now();
let core = null;
let module = null;  // the compiled core
let open = null;    // what the page has opened
let link = null;    // WebSocket, or the port of a player
let stream = null;
let operator = false;
let viewers = null;
let act = null;    // the last one of another operator
let asked_ms = 0;  // for the number of viewers
let rearms = 0;
let user = {
  paused: false,
  staticOn: true,
  dynamicOn: true,
  stiffnessFactor: 1,
  forceFactor: 1,
  friction: null
};
let showReliefs = true;
let showPictures = true;
let verified = false;

function sendStatus(state, text, share = null) {
  postMessage({type: 'status', state, text, share});
}

function sendStream() {
  const signature = stream.key === '' ? 'unsigned' : verified ? 'signed' : 'waiting';
  postMessage({type: 'stream', ...stream, operator, viewers, act, signature});
}

onmessage = async ({data}) => {
  switch (data.type) {
    case 'open':
      open = data;
      await start();
      break;
    case 'pointer':
      core?.e.point(data.x_mm, data.y_mm, data.z_mm);
      break;
    case 'user':
      ({type: data.type, ...user} = data);
      core?.setControls(user, rearms);
      break;
    case 'rearm':
      core?.setControls(user, ++rearms);
      break;
    case 'control':
      core?.control(data.control);
      break;
    case 'show':
      showReliefs = data.reliefs;
      showPictures = data.pictures;
      core?.e.requestPictures(Number(showPictures));
      break;
  }
};

async function start() {
  sendStatus('loading', 'loading the renderer');
  try {
    module = await WebAssembly.compile(await fetchBytes('core.wasm'));
    core = await startCore(module);
    core.start(open.originKeys ?? [], open.token ?? '', open.name ?? '');
    core.setControls(user, rearms);
    core.e.requestPictures(Number(showPictures));
  } catch (error) {
    return sendStatus('failed', `the renderer does not start: ${error.message}`);
  }
  last_ms = now_ms();
  setInterval(run, 1);
  connect();
}

/// Returns the bytes at `url`.
async function fetchBytes(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

// The session.

/// Begins a session of the core. Returns false if it may not be, for the reason that the core has.
function openSession() {
  const {protocol, hostname} = new URL(open.url);
  const ofThisMachine = open.source === 'recording' || hostname === 'localhost' ||
      hostname === '[::1]' || hostname.startsWith('127.');
  return core.open(renderDueTicks(), protocol === 'wss:', ofThisMachine);
}

function connect() {
  const recorded = open.source === 'recording';
  problem = '';
  stream = null;
  sendStatus('connecting', recorded ? 'opening the recording' : 'connecting to the server');
  if (!openSession()) return end();
  link = recorded ? makePlayer() : new WebSocket(open.url, 'hapticast.3');
  link.binaryType = 'arraybuffer';
  link.onopen = openSession;  // again: the time limit for the welcome begins here
  link.onmessage = ({data}) => onMessage(data);
  link.onclose = ({target, text}) => onClose(target, text);
}

function makePlayer() {
  return new PlayerLink(open.url, module, {
    onshare: (share) => sendStatus('loading', 'loading the recording', share),
    onproblem: (text) => {
      problem = text;
    },
  });
}

function onMessage(data) {
  if (typeof data === 'string') {
    core.setEnd('the server sent a text; is it a hapticast server?', true);
    return end();
  }
  const message = core.receive(new Uint8Array(data), renderDueTicks());
  switch (message.kind) {
    case 'error':
      return end();
    case 'welcome':
      verified = false;
      onWelcome();
      break;
    case 'description':
      stream = core.stream();
      sendStream();
      break;
    case 'frame':
      onFrame();
      break;
    case 'picture':
      postMessage(
          {type: 'picture', media_ms: message.value, jpeg: message.jpeg}, [message.jpeg.buffer]);
      break;
    case 'preparing':
      sendStatus('preparing', 'the server scans its clip', message.value);
      break;
    case 'control':
      onControl(message);
      break;
    case 'act':
      act = message.act;
      sendStream();
      break;
  }
}

function onWelcome() {
  stream = core.stream();
  operator = false;
  viewers = null;
  act = null;
  sendStatus('connected', '');
  sendStream();
  if (open.token) askForViewers();
}

/// Sends an empty request: an operator's answer has the number of viewers, a viewer's has none.
function askForViewers() {
  asked_ms = now_ms();
  core.control({});
}

function onFrame() {
  if (verified) return;
  verified = true;  // the core ends the session at a frame without a valid signature
  sendStream();
}

function onControl(message) {
  if (Number.isNaN(message.value) || message.value === viewers) return;
  operator = true;
  viewers = message.value;
  sendStream();
}

/// Returns a sentence of the server or of the core in the words of a page: a flag of the client is
/// a part of the link.
function toPage(sentence) {
  return sentence.replace('--token-file', '#token= in the link')
      .replace('--origin-key', '#origin-key= in the link')
      .replace('use hapticasts://HOST, or --insecure', 'open the link with https://');
}

/// Ends the session for the reason that the core has. Another one follows after the core's pause.
function end() {
  const ended = link;
  link = null;
  ended?.close();
  const {text, pause_ms} = core.close(renderDueTicks());
  const last = Number.isNaN(pause_ms) || open.source === 'recording';
  sendStatus(last ? 'failed' : 'retrying', toPage(text));
  if (!last) setTimeout(connect, pause_ms);
}

function onClose(closed, text) {
  if (closed !== link) return;  // it is not this session's any more
  core.setEnd(text ?? 'the server does not answer');
  end();
}

// The ticks.

const stats = {
  ticks: 0,
  late: 0,
  tick_us: 0
};
let last_ms = 0;  // time of the last tick
let reported_ms = 0;
let problem = '';      // of a recording
const lateAt_ms = [];  // late ticks of the last moments

/// Renders the ticks that are due; returns the time of the call. The core's clock never goes back:
/// each call passes this time to the core after its ticks, so that no tick to come is earlier than
/// the clock.
function renderDueTicks() {
  const begin_ms = now_ms();
  if (begin_ms - last_ms > kMostTicks) {
    stats.late++;
    lateAt_ms.push(begin_ms);
    last_ms = begin_ms - kMostTicks;
  }
  let ticks = 0;
  for (; last_ms + 1 <= begin_ms; ++ticks) core.e.tick(++last_ms);
  if (ticks > 0) {
    stats.ticks += ticks;
    stats.tick_us += 0.01 * ((1e3 * (now_ms() - begin_ms)) / ticks - stats.tick_us);
  }
  return begin_ms;
}

function run() {
  const begin_ms = renderDueTicks();
  if (core.e.prepare(begin_ms) && showReliefs) sendReliefs();
  const isOpen = link?.readyState === WebSocket.OPEN;
  if (isOpen) {
    for (const message of core.poll(begin_ms)) link.send(message);
    if (operator && begin_ms - asked_ms > kAskEvery_ms) askForViewers();
  }
  // A recording may load for long.
  if (open.source === 'stream' && link && core.e.expire(begin_ms) !== 0) end();
  if (begin_ms - reported_ms >= kReportEvery_ms) sendTicks(begin_ms);
}

function sendReliefs() {
  const reliefs = core.reliefs(kMostSamples);
  postMessage(
      {type: 'reliefs', ...reliefs}, reliefs.objects.map((object) => object.heights.buffer));
}

/// Sends the numbers and the sentences of one moment.
function sendTicks(begin_ms) {
  reported_ms = begin_ms;
  while (lateAt_ms.length > 0 && begin_ms - lateAt_ms[0] > kLateWithin_ms) lateAt_ms.shift();
  const busy = lateAt_ms.length >= kManyLate ?
      'this browser is busy: the page misses its milliseconds' :
      '';
  const lines = core.lines();
  const states = [lines.states, problem, busy].filter(Boolean).join('\n');
  const {frames_received, frames_lost, frames_late, media_now_ms, ...report} =
      core.report(begin_ms);
  const history = core.history();
  postMessage(
      {
        type: 'ticks',
        report: {...report, ...lines, states},
        history,
        stats: {...stats, frames_received, frames_lost, frames_late, media_now_ms}
      },
      [history.buffer]);
}
