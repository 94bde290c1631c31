// SPDX-License-Identifier: MIT
// The core: the client's own C++ as WebAssembly (client/web/viewer_exports.cpp). This file passes
// bytes in and out, and names the numbers that the core returns. Views of the core's memory are
// made anew in each call, because they end when the memory grows. Thread: the worker.

const kKinds =
    ['error', 'welcome', 'description', 'frame', 'picture', 'preparing', 'control', 'other'];
const kLookups = ['none', 'interpolated', 'extrapolated', 'held', 'faded'];

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
  numbers(at, count) { return new Float64Array(this.e.memory.buffer, at, count); }

  start(originKeys) {
    this.putText(originKeys.join(' '));
    this.e.start();
  }
  hello(token) {
    this.putText(token);
    return this.output(this.e.hello());
  }
  /// Processes a message. Returns {kind, value, bytes, error, code}, of which a kind has some.
  receive(bytes, now_ms) {
    this.put(bytes);
    const kind = kKinds[this.e.receive(now_ms)];
    if (kind === 'error')
      return {
        kind,
        error: this.text(this.e.outputSize()),
        code: this.e.errorCode(),
        untrusted: this.e.untrusted() !== 0
      };
    const bytesOfPicture = kind === 'picture' ? this.output(this.e.outputSize()) : null;
    return {kind, value: this.e.value(), bytes: bytesOfPicture};
  }
  /// Returns the messages for the server that are due.
  poll(now_ms) {
    const messages = [];
    for (let size = this.e.poll(now_ms); size > 0; size = this.e.poll(now_ms))
      messages.push(this.output(size));
    return messages;
  }
  control({paused = null, seek_s = NaN, speed = NaN, material = {}}) {
    const m = (name) => material[name] ?? NaN;
    return this.output(this.e.control(
        paused === null ? NaN : Number(paused), seek_s ?? NaN, speed ?? NaN, m('stiffness_N_mm'),
        m('damping_Ns_m'), m('static_friction'), m('dynamic_friction'), m('texture_K_mm'),
        m('mass_kg')));
  }
  /// Returns the description of the stream.
  stream() {
    const n = this.numbers(this.e.stream(), 11);
    const [width_px, height_px, fps, width_mm, height_mm, depth_mm] = n;
    const timeline =
        Number.isNaN(n[7]) ? null : {length_s: n[7], position_s: n[8], at_ms: n[9], speed: n[10]};
    const stretch = n[6] !== 0;
    return {
      width_px,
      height_px,
      fps,
      width_mm,
      height_mm,
      depth_mm,
      stretch,
      timeline,
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
    const n = this.numbers(this.e.report(now_ms), 28);
    const vector = (at) => [n[at], n[at + 1], n[at + 2]];
    return {
      play_ms: n[0],
      playout_delay_ms: n[1],
      hip_mm: vector(2),
      contact_mm: vector(5),
      force_N: vector(8),
      static_force_N: vector(11),
      dynamic_force_N: vector(14),
      penetration_mm: n[17],
      contact: n[18] !== 0,
      lookup: kLookups[n[19]],
      over_object: n[20] !== 0,
      height_at_hip_mm: n[21],
      object_present: n[22] !== 0,
      halted: n[23] !== 0,
      frames_received: n[24],
      frames_lost: n[25],
      frames_late: n[26],
      media_now_ms: n[27],
    };
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
      const [u, v, width, height, columns, rows, step] =
          this.numbers(this.e.sampleRelief(i, mostSide), 7);
      if (columns === 0) continue;
      const heights =
          new Float32Array(this.e.memory.buffer, this.e.heights(), columns * rows).slice();
      objects.push({id: i, u, v, width, height, columns, rows, step, heights});
    }
    return {media_ms: this.e.reliefTime_ms(), objects};
  }
}
