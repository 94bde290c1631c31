// SPDX-License-Identifier: MIT
// A file of a web server that is read at any place. If the server answers ranges (RFC 9110, section
// 14), blocks are read when they are needed, and the next ones ahead. Otherwise the whole file is
// loaded first. The reads are synchronous, which a worker may do. Thread: the worker of the player.

const kBlock_bytes = 256 * 1024;  // chosen: a second of a stream with pictures
const kMostBlocks = 64;           // in memory: 16 MB
const kAhead = 3;                 // blocks
const kMostWhole_bytes = 100e6;
const kTimeout_ms = 20_000;  // of a block; chosen: 13 kB/s
const kRetry_ms = 1000;      // chosen

/// Opens the file at `url`. `onShare` receives the loaded share of a whole file, 0..1. Throws an
/// Error with one sentence.
export async function openFile(url, onShare) {
  const response = await fetch(url, {headers: {Range: 'bytes=0-0'}});
  if (!response.ok) throw new Error(`the web server has no ${findName(url)} (${response.status})`);
  const size = Number(/^bytes 0-0\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '')?.[1]);
  if (response.status === 206 && size > 0 && (await response.arrayBuffer()).byteLength === 1)
    return new RangedFile(url, size);
  if (response.status === 206)
    throw new Error('the web server answers ranges wrongly; use another one');
  return new WholeFile(await loadWhole(url, response, onShare));
}

function findName(url) { return new URL(url).pathname.split('/').pop(); }

async function loadWhole(url, response, onShare) {
  const expected = Number(response.headers.get('Content-Length'));
  const tooLarge = () => new Error(`${
      findName(
          url)} is larger than 100 MB, and the web server answers no ranges; use one that does`);
  if (expected > kMostWhole_bytes) throw tooLarge();
  const parts = [];
  let size = 0;
  for (const reader = response.body.getReader();;) {
    const {done, value} = await reader.read();
    if (done) break;
    parts.push(value);
    size += value.length;
    if (size > kMostWhole_bytes) {
      reader.cancel();
      throw tooLarge();
    }
    if (expected > 0) onShare(Math.min(1, size / expected));
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

class WholeFile {
  constructor(bytes) {
    this.bytes = bytes;
    this.size = bytes.length;
  }
  /// Fills `to` with the bytes from `offset`. Returns their number.
  read(offset, to) {
    const part = this.bytes.subarray(offset, offset + to.length);
    to.set(part);
    return part.length;
  }
}

class RangedFile {
  constructor(url, size) {
    this.url = url;
    this.size = size;
    this.blocks = new Map();  // number -> bytes, the newest last
    this.loading = new Set();
    this.failure = '';
    this.retry_ms = 0;  // after a failure; a file without an answer is asked for once a second
  }

  read(offset, to) {
    let done = 0;
    while (done < to.length && offset + done < this.size) {
      const index = Math.floor((offset + done) / kBlock_bytes);
      const block = this.blocks.get(index) ?? this.loadNow(index);
      if (!block) break;
      const part =
          block.subarray(offset + done - index * kBlock_bytes).subarray(0, to.length - done);
      if (part.length === 0) break;
      to.set(part, done);
      done += part.length;
      for (let i = 1; i <= kAhead; ++i) this.loadAhead(index + i);
    }
    return done;
  }

  findRange(index) {
    const begin = index * kBlock_bytes;
    return {begin, end: Math.min(begin + kBlock_bytes, this.size) - 1};
  }
  store(index, bytes) {
    this.blocks.set(index, bytes);
    if (this.blocks.size > kMostBlocks) this.blocks.delete(this.blocks.keys().next().value);
    return bytes;
  }
  /// Returns whether an answer has exactly the bytes that were requested.
  isAnswer({begin, end}, status, contentRange, size) {
    return status === 206 && contentRange === `bytes ${begin}-${end}/${this.size}` &&
        size === end - begin + 1;
  }
  fail(sentence) {
    this.failure = sentence;
    this.retry_ms = performance.now() + kRetry_ms;
    return null;
  }
  loadNow(index) {
    if (performance.now() < this.retry_ms) return null;
    const range = this.findRange(index);
    const request = new XMLHttpRequest();
    try {
      request.open('GET', this.url, false);
      request.timeout = kTimeout_ms;
      request.responseType = 'arraybuffer';
      request.setRequestHeader('Range', `bytes=${range.begin}-${range.end}`);
      request.send();
    } catch {
      return this.fail('the web server does not answer');
    }
    const answer = request.response;
    if (!this.isAnswer(
            range, request.status, request.getResponseHeader('Content-Range'), answer?.byteLength))
      return this.fail(`the web server answers ranges wrongly (${request.status})`);
    this.failure = '';
    return this.store(index, new Uint8Array(answer));
  }
  async loadAhead(index) {
    if (index * kBlock_bytes >= this.size || this.blocks.has(index) || this.loading.has(index))
      return;
    this.loading.add(index);
    const range = this.findRange(index);
    try {
      const response =
          await fetch(this.url, {headers: {Range: `bytes=${range.begin}-${range.end}`}});
      const bytes = new Uint8Array(await response.arrayBuffer());
      if (this.isAnswer(
              range, response.status, response.headers.get('Content-Range'), bytes.length))
        this.store(index, bytes);
    } catch {
      // The block is loaded again when it is needed.
    } finally {
      this.loading.delete(index);
    }
  }
}
