// SPDX-License-Identifier: MIT
// The force of the last eight seconds: a ring of columns of 20 ms, each with its peaks.

import {kColours} from './overlay.js';

const kSpan_s = 8;  // as in the native window: a press and its release
const kTicks = 20;  // of a column
const kColumns = kSpan_s * 1000 / kTicks;
const kCurves = [['force', 'device'], ['static', 'static'], ['dynamic', 'dynamic']];
const kLabel_px = 40, kHead_px = 16, kFoot_px = 14;

export class ForcePlot {
  columns = new Float32Array(4 * kColumns);
  next = 0;   // column that is being filled
  ticks = 0;  // in this column
  changed = true;

  constructor(canvas) { this.canvas = canvas; }

  add(history) {
    for (let i = 0; i + 3 < history.length; i += 4) {
      const at = 4 * this.next;
      for (let k = 0; k < 4; ++k)
        this.columns[at + k] = Math.max(this.columns[at + k], history[i + k]);
      if (++this.ticks < kTicks) continue;
      this.ticks = 0;
      this.next = (this.next + 1) % kColumns;
      this.columns.fill(0, 4 * this.next, 4 * this.next + 4);
    }
    this.changed = history.length > 0;
  }

  draw() {
    const {canvas} = this;
    if (!this.changed || canvas.clientWidth === 0) return;
    this.changed = false;
    const ratio = Math.min(devicePixelRatio, 2);
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = '#181a1c';
    g.fillRect(0, 0, width, height);
    g.font = '11px sans-serif';
    const peak_N = this.findPeak_N();
    const step_N = peak_N <= 1 ? 0.25 : peak_N <= 2.5 ? 0.5 : 1;
    const top_N = step_N * Math.ceil(peak_N / step_N);
    const area = {
      x: kLabel_px,
      y: kHead_px,
      width: width - kLabel_px - 4,
      height: height - kHead_px - kFoot_px
    };
    this.drawContacts(g, area);
    this.drawGrid(g, area, top_N, step_N);
    kCurves.forEach((_, k) => this.drawCurve(g, area, top_N, k));
    this.drawNames(g, area);
  }

  findPeak_N() {
    let peak_N = 0.5;
    for (let i = 0; i < this.columns.length; i += 4)
      peak_N = Math.max(peak_N, this.columns[i], this.columns[i + 1], this.columns[i + 2]);
    return peak_N;
  }

  drawContacts(g, area) {
    g.fillStyle = '#28343a';
    const step = area.width / kColumns;
    for (let i = 0; i < kColumns; ++i)
      if (this.columns[4 * ((this.next + 1 + i) % kColumns) + 3] > 0)
        g.fillRect(area.x + i * step, area.y, step + 0.5, area.height);
  }

  drawGrid(g, area, top_N, step_N) {
    g.fillStyle = '#d0d4d7';
    g.textAlign = 'right';
    for (let force_N = 0; force_N <= top_N + 1e-9; force_N += step_N) {
      const y = area.y + area.height * (1 - force_N / top_N);
      g.fillText(force_N.toFixed(2) + ' N', area.x - 3, y + 4);
      g.fillRect(area.x, y, area.width, force_N === 0 ? 1 : 0.25);
    }
    g.textAlign = 'center';
    for (let s = 0; s <= kSpan_s; s += 2)
      g.fillText(
          s === kSpan_s ? '0 s' : `-${kSpan_s - s} s`,
          Math.min(area.x + area.width * s / kSpan_s, area.x + area.width - 8),
          area.y + area.height + 12);
  }

  drawCurve(g, area, top_N, k) {
    g.beginPath();
    for (let i = 0; i < kColumns; ++i) {
      const value_N = this.columns[4 * ((this.next + 1 + i) % kColumns) + k];
      g.lineTo(
          area.x + area.width * i / (kColumns - 1), area.y + area.height * (1 - value_N / top_N));
    }
    g.lineWidth = 1.25;
    g.strokeStyle = k === 1 ? '#6f9bff' : kColours[kCurves[k][0]];
    g.stroke();
  }

  drawNames(g, area) {
    g.textAlign = 'left';
    let x = area.x;
    for (const [name, text] of kCurves) {
      g.fillStyle = name === 'static' ? '#6f9bff' : name === 'dynamic' ? '#ff6a63' : kColours[name];
      g.fillText(text, x, 11);
      x += g.measureText(text).width + 10;
    }
  }
}
