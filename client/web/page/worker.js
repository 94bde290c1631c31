// SPDX-License-Identifier: MIT
// The worker of the page: it runs the session with the server and a tick for each millisecond. A
// timer of a page is late by some milliseconds, so each call renders the ticks that are due, 20 at
// most. Frames are prepared between the ticks, one in each call. The page sends `open`, `pointer`,
// `user`, `rearm`, `control` and `show`; it receives `status`, `stream`, `picture`, `reliefs` and
// `ticks`.
import {startCore} from './core.js';
import {PlayerLink} from './player_link.js';

const kMostTicks = 20;       // in one call; a longer gap is a late tick, and its ticks are left out
const kReportEvery_ms = 16;  // chosen: once for each picture of a screen
const kAskEvery_ms = 2000;   // chosen: an operator sees viewers come and go
const kSilence_ms = 3000;    // as the native client: no message for so long counts as a loss
const kWelcome_ms = 5000;    // as the native client
const kPong_ms = 5000;       // as the native client
const kFirstRetry_ms = 200;
const kLastRetry_ms = 1000;
const kLateWithin_ms = 10_000;  // chosen, with kManyLate: a page that is often late, not once
const kManyLate = 10;
const kMostSamples = 96;  // along a side of a relief; chosen: a screen shows no more of an object
// Errors after which a retry is of no use: version and wrong token (proto/README.md, section 7).
const kPermanent = new Set([3, 8]);

const now_ms = () => performance.now();
let core = null;
let module = null;  // the compiled core
let open = null;    // what the page has opened
let link = null;    // WebSocket, or the port of a player
let stream = null;
let operator = false;
let viewers = null;
let asked_ms = 0;  // for the number of viewers
let pause_ms = kFirstRetry_ms;
let lastMessage_ms = 0;
let firstFrame_ms = null;
let welcomed_ms = null;
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
let verified = false;

function sendStatus(state, text, share = null) {
  postMessage({type: 'status', state, text, share});
}

function sendStream() {
  const signature = stream.key === '' ? 'unsigned' : verified ? 'signed' : 'waiting';
  postMessage({type: 'stream', ...stream, operator, viewers, signature});
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
      if (link?.readyState === WebSocket.OPEN) link.send(core.control(data.control));
      break;
    case 'show':
      showReliefs = data.reliefs;
      break;
  }
};

async function start() {
  sendStatus('loading', 'loading the renderer');
  try {
    module = await WebAssembly.compile(await fetchBytes('core.wasm'));
    core = await startCore(module);
    core.start(open.originKeys ?? []);
    core.setControls(user, rearms);
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

/// Returns whether a token may go to the server of the link: over https, or to this machine.
function mayHaveToken() {
  const {protocol, hostname} = new URL(open.url);
  return protocol === 'wss:' || hostname === 'localhost' || hostname === '[::1]' ||
      hostname.startsWith('127.');
}

function connect() {
  const recorded = open.source === 'recording';
  if (open.token && !recorded && !mayHaveToken())
    return sendStatus(
        'failed',
        'the token would go unprotected through the network: open the link with https://');
  problem = '';
  welcomed_ms = null;
  sendStatus('connecting', recorded ? 'opening the recording' : 'connecting to the server');
  firstFrame_ms = null;
  stream = null;
  link = recorded ? makePlayer() : new WebSocket(open.url, 'hapticast.3');
  link.binaryType = 'arraybuffer';
  lastMessage_ms = now_ms() + kWelcome_ms - kSilence_ms;
  link.onopen = () => {
    lastMessage_ms = now_ms() + kWelcome_ms - kSilence_ms;
    link.send(core.hello(open.token ?? ''));
  };
  link.onmessage = ({data}) => onMessage(data);
  link.onclose = ({target, text}) =>
      onClose(target, text ?? 'the server does not answer', recorded);
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
  if (typeof data === 'string') return fail('the server sent a text; is it a hapticast server?');
  const begin_ms = renderDueTicks();
  lastMessage_ms = Math.max(lastMessage_ms, begin_ms);
  const message = core.receive(new Uint8Array(data), begin_ms);
  switch (message.kind) {
    case 'error':
      return fail(message.error, kPermanent.has(message.code) || message.untrusted);
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
          {type: 'picture', media_ms: message.value, jpeg: message.bytes}, [message.bytes.buffer]);
      break;
    case 'preparing':
      sendStatus('preparing', 'the server scans its clip', message.value);
      break;
    case 'control':
      onControl(message);
      break;
  }
}

function onWelcome() {
  stream = core.stream();
  welcomed_ms = now_ms();
  operator = false;
  viewers = null;
  sendStatus('connected', '');
  sendStream();
  if (open.token) askForViewers();
}

/// Sends an empty request: an operator's answer has the number of viewers, a viewer's has none.
function askForViewers() {
  asked_ms = now_ms();
  link.send(core.control({}));
}

function onFrame() {
  firstFrame_ms ??= now_ms();
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
      .replace('--origin-key', '#origin-key= in the link');
}

/// Ends the session with a sentence. `permanent`: no retry follows.
function fail(text, permanent = true) {
  const sentence = toPage(text);
  const ended = link;
  link = null;
  ended?.close();
  core.e.disconnect(renderDueTicks());
  if (permanent) return sendStatus('failed', sentence);
  retry(sentence);
}

function onClose(closed, sentence, permanent) {
  if (closed !== link) return;  // it is not this session's any more
  fail(sentence, permanent);
}

function retry(sentence) {
  if (firstFrame_ms !== null && now_ms() - firstFrame_ms > kSilence_ms) pause_ms = kFirstRetry_ms;
  sendStatus('retrying', sentence);
  setTimeout(connect, pause_ms);
  pause_ms = Math.min(2 * pause_ms, kLastRetry_ms);
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
  if (open.source === 'stream') checkServer(begin_ms);  // a recording may load for long
  if (begin_ms - reported_ms >= kReportEvery_ms) sendTicks(begin_ms);
}

/// Gives up a server that sends nothing, or answers no pings.
function checkServer(begin_ms) {
  if (link && begin_ms - lastMessage_ms > kSilence_ms)
    return fail(stream ? 'the server stopped sending' : 'no welcome arrived', false);
  const waits = link && welcomed_ms !== null && begin_ms - welcomed_ms > kPong_ms;
  if (waits && core.report(begin_ms).media_now_ms === 0)
    return fail('the server answers no pings', false);
  if (waits) welcomed_ms = null;  // the clocks are synchronised
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
