// SPDX-License-Identifier: MIT
// Texts of the page: connection, signature, advice, hint, states, force. Visible texts change ten
// times a second at most. A screen reader hears the advice when its words change, every two seconds
// at most.

import {norm} from './geometry.js';
import {find, setText} from './panel.js';

const kAnnounce_ms = 2000;
const kMost_N = 3.3;  // end of the gauge

export class StatusTexts {
  announced = '';
  announced_ms = -Infinity;

  showStatus({state, text, share}) {
    const card = find('card');
    card.hidden = state === 'connected';
    card.className = state;
    setText(find('connection'), state);
    const isCounted = state === 'loading' || state === 'preparing';
    const percent = isCounted && share > 0 ? ` ${Math.round(100 * share)} %` : '';
    const sentence =
        (text || state) + (state === 'retrying' ? ': the page connects again' : percent);
    setText(find('card-text'), sentence);
    const progress = find('progress');
    progress.hidden = state === 'failed' || state === 'retrying';
    if (isCounted && share > 0)
      progress.value = share;
    else
      progress.removeAttribute('value');
    if (state !== 'connected') {
      setText(find('advice'), '\u00a0');
      find('hint').hidden = true;
      find('states').hidden = true;
    }
    if (!isCounted) this.announce(sentence);
  }

  showStream(stream) {
    setText(find('name'), stream.name || 'hapticast');
    document.title = `${stream.name || 'stream'} - hapticast`;
    find('name').title = stream.name;
    const viewers = find('viewers');
    viewers.hidden = stream.viewers === null || stream.viewers === undefined;
    setText(viewers, stream.viewers === 1 ? '1 viewer' : `${stream.viewers} viewers`);
    const signature = find('signature');
    signature.hidden = false;
    const short = stream.key ? `${stream.key.slice(0, 8)}…${stream.key.slice(-4)}` : '';
    setText(
        signature,
        stream.signature === 'signed' ? `signed by ${short}` :
            stream.signature === 'waiting' ? 'waiting for the signature' :
                                             'not signed');
    signature.className = stream.signature === 'signed' ? 'good' : '';
    signature.title = stream.key ? `key ${stream.key}` : '';
  }

  /// Shows the texts of a message 'ticks'.
  showTicks(ticks, isTouchScreen) {
    const {report} = ticks;
    const {advice, hint, states} = report;
    setText(find('advice'), advice || '\u00a0');
    find('advice').className = report.contact ? 'contact' : '';
    find('states').hidden = !states;
    setText(find('states'), states ?? '');
    const words = isTouchScreen && /wheel/.test(hint) ?
        'Rest a finger on the object to press. Help: keys and colours.' :
        hint;
    find('hint').hidden = !words;
    setText(find('hint'), words ?? '');
    this.showForce(report);
    this.announce(states ? `${advice}. ${states}` : advice);
  }

  /// Shows the force, also without a connection: it fades then.
  showForce(report) {
    const force_N = norm(report.force_N);
    setText(find('force-text'), `${force_N.toFixed(2)} N`);
    setText(
        find('force-line'),
        `${force_N.toFixed(2)} N, penetration ${report.penetration_mm.toFixed(2)} mm`);
    find('gauge-bar').style.transform = `scaleX(${Math.min(1, force_N / kMost_N).toFixed(3)})`;
    find('gauge').setAttribute('aria-valuenow', Math.min(force_N, kMost_N).toFixed(1));
    find('rearm').hidden = !report.halted;
  }

  announce(text) {
    const words = (text ?? '').replace(/[\d.,]+/g, '#');
    const now_ms = performance.now();
    if (words === this.announced || now_ms - this.announced_ms < kAnnounce_ms) return;
    this.announced = words;
    this.announced_ms = now_ms;
    setText(find('announcer'), text);
  }
}
