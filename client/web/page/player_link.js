// SPDX-License-Identifier: MIT
// The link to the player of a static folder, with the interface of a WebSocket as far as worker.js
// uses it. Thread: the worker of the page.

export class PlayerLink {
  /// `module`: the compiled core. `events`: onshare(share), onproblem(text).
  constructor(url, module, events) {
    this.readyState = WebSocket.CONNECTING;
    this.worker = new Worker('player.js', {type: 'module'});
    this.worker.onmessage = ({data}) => this.onPlayer(data, events);
    this.worker.onerror = () => this.end('the player does not start');
    this.worker.postMessage({url, module});
  }

  onPlayer(data, events) {
    if (data instanceof Uint8Array) return this.onmessage({data: data.buffer});
    if (data.type === 'share') return events.onshare(data.share);
    if (data.type === 'problem') return events.onproblem(data.text);
    if (data.type === 'failed') return this.end(data.text);
    this.readyState = WebSocket.OPEN;
    this.onopen();
  }
  end(text) {
    this.close();
    this.onclose({target: this, text});
  }
  send(bytes) { this.worker.postMessage(bytes); }
  close() {
    this.readyState = WebSocket.CLOSED;
    this.worker.terminate();
  }
}
