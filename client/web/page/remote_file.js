// SPDX-License-Identifier: MIT
// A file of a web server that is read at any place. If the server answers ranges (RFC 9110, section
// 14), blocks are read when they are needed, and the next ones ahead. Otherwise the whole file is
// loaded first. The reads are synchronous, which a worker may do. Thread: the worker of the player.

const BLOCK_BYTES = 256 * 1024; // chosen: a second of a stream with pictures
const MOST_BLOCKS = 64; // in memory: 16 MB
const AHEAD = 3; // blocks
const MOST_WHOLE_BYTES = 100e6;

/// Opens the file at `url`. `onShare` receives the loaded share of a whole file, 0..1. Throws an
/// Error with one sentence.
export async function openFile(url, onShare) {
  const response = await fetch(url, { headers: { Range: 'bytes=0-0' } });
  if (!response.ok) throw new Error(`the web server has no ${nameOf(url)} (${response.status})`);
  const size = Number(/^bytes 0-0\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '')?.[1]);
  if (response.status === 206 && size > 0 && (await response.arrayBuffer()).byteLength === 1) return new RangedFile(url, size);
  if (response.status === 206) throw new Error('the web server answers ranges wrongly; use another one');
  return new WholeFile(await loadWhole(url, response, onShare));
}

function nameOf(url) {
  return new URL(url).pathname.split('/').pop();
}

async function loadWhole(url, response, onShare) {
  const expected = Number(response.headers.get('Content-Length'));
  const tooLarge = () =>
    new Error(`${nameOf(url)} is larger than 100 MB, and the web server answers no ranges; use one that does`);
  if (expected > MOST_WHOLE_BYTES) throw tooLarge();
  const parts = [];
  let size = 0;
  for (const reader = response.body.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    size += value.length;
    if (size > MOST_WHOLE_BYTES) {
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
    this.blocks = new Map(); // number -> bytes, the newest last
    this.loading = new Set();
    this.failure = '';
  }

  read(offset, to) {
    let done = 0;
    while (done < to.length && offset + done < this.size) {
      const index = Math.floor((offset + done) / BLOCK_BYTES);
      const block = this.blocks.get(index) ?? this.loadNow(index);
      if (!block) break;
      const part = block.subarray(offset + done - index * BLOCK_BYTES).subarray(0, to.length - done);
      if (part.length === 0) break;
      to.set(part, done);
      done += part.length;
      for (let i = 1; i <= AHEAD; ++i) this.loadAhead(index + i);
    }
    return done;
  }

  range(index) {
    const begin = index * BLOCK_BYTES;
    return { begin, end: Math.min(begin + BLOCK_BYTES, this.size) - 1 };
  }
  store(index, bytes) {
    this.blocks.set(index, bytes);
    if (this.blocks.size > MOST_BLOCKS) this.blocks.delete(this.blocks.keys().next().value);
    return bytes;
  }
  /// Returns whether an answer has exactly the bytes that were requested.
  isAnswer({ begin, end }, status, contentRange, size) {
    const ok = status === 206 && contentRange === `bytes ${begin}-${end}/${this.size}` && size === end - begin + 1;
    if (!ok) this.failure = `the web server answers ranges wrongly (${status})`;
    return ok;
  }
  loadNow(index) {
    const range = this.range(index);
    const request = new XMLHttpRequest();
    try {
      request.open('GET', this.url, false);
      request.responseType = 'arraybuffer';
      request.setRequestHeader('Range', `bytes=${range.begin}-${range.end}`);
      request.send();
    } catch (error) {
      this.failure = 'the web server does not answer';
      return null;
    }
    const answer = request.response;
    const header = request.getResponseHeader('Content-Range');
    return this.isAnswer(range, request.status, header, answer?.byteLength) ? this.store(index, new Uint8Array(answer)) : null;
  }
  async loadAhead(index) {
    if (index * BLOCK_BYTES >= this.size || this.blocks.has(index) || this.loading.has(index)) return;
    this.loading.add(index);
    const range = this.range(index);
    try {
      const response = await fetch(this.url, { headers: { Range: `bytes=${range.begin}-${range.end}` } });
      const bytes = new Uint8Array(await response.arrayBuffer());
      if (this.isAnswer(range, response.status, response.headers.get('Content-Range'), bytes.length)) this.store(index, bytes);
    } catch {
      // The block is loaded again when it is needed.
    } finally {
      this.loading.delete(index);
    }
  }
}
