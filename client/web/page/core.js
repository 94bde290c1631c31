// SPDX-License-Identifier: MIT
// The core: the client's own C++ as WebAssembly (client/web/viewer_exports.cpp). This file passes
// bytes in and out, and numbers with the names that the core has for them. Views of the core's
// memory are made anew in each call, because they end when the memory grows. Thread: the worker.

/// Returns the functions that the core imports. `memory()` returns its memory.
function makeImports(memory, readFile) {
  const bytes = (at, size) => new Uint8Array(memory().buffer, at, size);
  return {
    page: {
      // A recording's bytes; only a player reads some.
      file_size: () => readFile.size,
      read: (offset, size, to) => readFile.read(offset, bytes(to, size)),
    },
  };
}

/// Starts the compiled core. `readFile`: a file for the player (remote_file.js), or nothing.
export async function startCore(module, readFile = {
  size: 0,
  read: () => 0
}) {
  let instance;
  const imports = makeImports(() => instance.exports.memory, readFile);
  for (const {module: from, name} of WebAssembly.Module.imports(module))
    if (!imports[from]?.[name])
      (imports[from] ??= {})[name] = () => {
        throw new Error('the core called ' + name);
      };
  instance = await WebAssembly.instantiate(module, imports);
  instance.exports._initialize();
  return new Core(instance.exports);
}

/// The functions of the core, with the types of JavaScript.
export class Core {
  constructor(exports) { this.e = exports; }

  put(bytes) {
    new Uint8Array(this.e.memory.buffer, this.e.webInput(bytes.length), bytes.length).set(bytes);
  }
  putText(text) { this.put(new TextEncoder().encode(text)); }
  /// Returns a copy of the core's output.
  output(size) { return new Uint8Array(this.e.memory.buffer, this.e.webOutput(), size).slice(); }
  text(size) {
    return new TextDecoder().decode(
        new Uint8Array(this.e.memory.buffer, this.e.webOutput(), size));
  }
  /// Returns the numbers of `result`, an array of the core, by their names. Elements with one name
  /// are a vector.
  numbers(result) {
    const values = new Float64Array(this.e.memory.buffer, result, this.e.count()).slice();
    const numbers = {};
    const names = this.text(this.e.names()).split(' ');
    values.forEach((value, i) => {
      const name = names[i];
      numbers[name] = name in numbers ? [numbers[name], value].flat() : value;
    });
    return numbers;
  }

  start(originKeys, token, name = '') {
    this.putText([originKeys.join(' '), name.replace(/\s+/g, ' '), token].join('\n'));
    this.e.start();
  }
  /// Begins a session. Returns whether it may be; else close() follows.
  open(now_ms, encrypted, ofThisMachine) {
    return this.e.openSession(now_ms, Number(encrypted), Number(ofThisMachine)) !== 0;
  }
  /// Processes a message. Returns {kind, value, jpeg, act}, of which a kind has some. Kind 'error':
  /// close() follows.
  receive(bytes, now_ms) {
    this.put(bytes);
    const kind = this.text(this.e.receive(now_ms));
    return {
      kind,
      value: this.e.value(),
      jpeg: kind === 'picture' ? this.output(this.e.picture()) : null,
      act: kind === 'act' ? {name: this.text(this.e.actor()), ...this.numbers(this.e.act())} : null
    };
  }
  /// Sets why the connection has ended. `malformed`: the peer sent what is no message.
  setEnd(text, malformed = false) {
    this.putText(text);
    this.e.setEnd(Number(malformed));
  }
  /// Ends the session. Returns why, and the pause until the next one; NaN: none can succeed.
  close(now_ms) {
    const pause_ms = this.e.closeSession(now_ms);
    return {text: this.text(this.e.outputSize()), pause_ms};
  }
  /// Returns the messages for the server that are due.
  poll(now_ms) {
    const messages = [];
    for (let size = this.e.poll(now_ms); size > 0; size = this.e.poll(now_ms))
      messages.push(this.output(size));
    return messages;
  }
  /// Requests something of the server, with the next poll().
  control({paused = null, seek_s = NaN, speed = NaN, material = {}}) {
    const m = (name) => material[name] ?? NaN;
    this.e.control(
        paused === null ? NaN : Number(paused), seek_s ?? NaN, speed ?? NaN, m('stiffness_N_mm'),
        m('damping_Ns_m'), m('static_friction'), m('dynamic_friction'), m('texture_K_mm'),
        m('mass_kg'));
  }
  /// Returns the description of the stream.
  stream() {
    const timeline = this.numbers(this.e.timeline());
    const numbers = this.numbers(this.e.stream());
    return {
      ...numbers,
      stretch: numbers.stretch !== 0,
      timeline: 'length_s' in timeline ? timeline : null,
      name: this.text(this.e.streamName()),
      key: this.text(this.e.serverKey())
    };
  }
  setControls({paused, staticOn, dynamicOn, stiffnessFactor, forceFactor, friction}, rearm) {
    this.e.setControls(
        Number(paused), rearm, Number(staticOn), Number(dynamicOn), stiffnessFactor, forceFactor,
        friction ?? NaN);
  }
  /// Returns what the last tick reported, and the counts of frames.
  report(now_ms) {
    const report = this.numbers(this.e.report(now_ms));
    for (const name of ['contact', 'over_object', 'object_present', 'halted'])
      report[name] = report[name] !== 0;
    return {...report, lookup: this.text(this.e.lookup())};
  }
  lines() {
    return {
      advice: this.text(this.e.advice()),
      hint: this.text(this.e.hint()),
      states: this.text(this.e.states())
    };
  }
  history() {
    const at = this.e.history();
    return new Float32Array(this.e.memory.buffer, at, this.e.historySize()).slice();
  }
  /// Returns the reliefs of the newest prepared frame, at most `mostSide` heights along each side.
  reliefs(mostSide) {
    const objects = [];
    for (let i = 0; i < this.e.reliefCount(); ++i) {
      const relief = this.numbers(this.e.sampleRelief(i, mostSide));
      if (!relief.columns) continue;
      const size = relief.columns * relief.rows;
      const heights = new Float32Array(this.e.memory.buffer, this.e.heights(), size).slice();
      objects.push({id: i, ...relief, heights});
    }
    return {media_ms: this.e.reliefTime_ms(), objects};
  }
}
