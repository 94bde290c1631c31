// SPDX-License-Identifier: MIT
// The two views: the flat picture, and the relief from the side. Each has a canvas for the content
// and a canvas above it for the touch. A canvas is drawn only if its content has changed.

import {Camera, computeScale, FlatView} from './geometry.js';
import {drawTouch} from './overlay.js';
import {find} from './panel.js';
import {ReliefRenderer} from './relief.js';

const kWide_px = 1200;  // both views side by side
const kNone = [];
const kVisible = 2e-3;  // mm or N: less than a tenth of a pixel

class Pane {
  dirty = true;

  constructor(id, content, overlay, view) {
    this.element = find(id);
    this.content = find(content);
    this.overlay = find(overlay);
    this.g = this.overlay.getContext('2d');
    this.view = view;
    new ResizeObserver(() => {
      this.resized = true;
    }).observe(this.element);
    this.resized = true;
  }

  /// Adapts canvas and view to the size of the element.
  fit(stream, resizesContent) {
    const width_px = this.element.clientWidth, height_px = this.element.clientHeight;
    if (width_px === 0 || height_px === 0) return false;
    const ratio = Math.min(devicePixelRatio, 2);
    for (const canvas of resizesContent ? [this.overlay, this.content] : [this.overlay]) {
      canvas.width = Math.round(width_px * ratio);
      canvas.height = Math.round(height_px * ratio);
    }
    this.g.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.size_px = [width_px, height_px];
    this.view.fit(stream, width_px, height_px);
    this.resized = false;
    this.dirty = true;
    return true;
  }

  clear() {
    if (this.size_px) this.g.clearRect(0, 0, ...this.size_px);
  }
}

export class Views {
  stream = null;
  mode = 'picture';
  drawn = null;  // numbers of the touch that is drawn
  drawings = {pictures: 0, reliefs: 0, overlays: 0};

  constructor(settings) {
    this.settings = settings;
    this.camera = new Camera();
    this.flat = new Pane('flat', 'picture', 'flat-overlay', new FlatView());
    this.relief = new Pane('relief', 'mesh', 'relief-overlay', this.camera);
    this.picture = this.flat.content.getContext('2d');
    this.problem = '';
    try {
      this.renderer = new ReliefRenderer(this.relief.content);
    } catch (error) {
      this.renderer = null;
      this.problem = error.message;
    }
    this.watchContext();
    find('relief-note').hidden = this.renderer !== null;
    find('view-button').disabled = this.renderer === null;
    this.choose(settings.view ?? (innerWidth >= kWide_px ? 'both' : 'picture'));
  }

  watchContext() {
    this.relief.content.addEventListener('webglcontextlost', event => event.preventDefault());
    this.relief.content.addEventListener('webglcontextrestored', () => {
      this.renderer.restore();
      this.renewed = true;
    });
  }

  /// Shows 'picture', 'relief' or 'both'.
  choose(mode) {
    this.mode = this.renderer ? mode : 'picture';
    this.flat.element.hidden = this.mode === 'relief';
    this.relief.element.hidden = this.mode === 'picture';
    this.flat.resized = this.relief.resized = this.renewed = true;
  }

  get showsRelief() { return this.mode !== 'picture'; }

  chooseNext() {
    const modes = ['picture', 'relief', 'both'];
    this.choose(modes[(modes.indexOf(this.mode) + 1) % modes.length]);
    return this.mode;
  }

  setStream(stream) {
    this.stream = stream;
    find('stage').style.setProperty('--aspect', `${stream.width_px} / ${stream.height_px}`);
    if (this.flat.content.width !== stream.width_px ||
        this.flat.content.height !== stream.height_px)
      Object.assign(this.flat.content, {width: stream.width_px, height: stream.height_px});
    this.flat.resized = this.relief.resized = this.renewed = true;
  }

  turn(yaw_rad, pitch_rad) {
    this.camera.turn(yaw_rad, pitch_rad);
    this.relief.resized = true;
  }

  /// Draws what has changed. `changed` is that of Film.select(); `touch` {report, target} is null
  /// without one.
  draw(film, changed, touch) {
    if (!this.stream) return;
    this.touched = this.hasMoved(touch);
    const isNew = this.renewed;
    this.renewed = false;
    const bitmap = film.shownPicture?.bitmap;
    if (!this.flat.element.hidden) {
      if (this.flat.resized) this.flat.fit(this.stream, false);
      if (bitmap && (changed.picture || isNew)) this.drawPicture(bitmap);
      this.drawOverlay(this.flat, touch);
    }
    if (!this.relief.element.hidden) {
      this.drawRelief(bitmap, film.shownReliefs?.objects ?? kNone, changed, isNew);
      this.drawOverlay(this.relief, touch);
    }
  }

  /// Returns true if `touch` looks different from the touch before.
  hasMoved(touch) {
    const before = this.drawn;
    this.drawn = touch && [
      ...touch.report.hip_mm, ...touch.report.contact_mm, ...touch.report.force_N,
      ...touch.report.dynamic_force_N, touch.report.height_at_hip_mm, Number(touch.report.contact),
      touch.target.x_mm, touch.target.y_mm
    ];
    if (!before || !touch) return before !== this.drawn;
    return this.drawn.some((value, i) => Math.abs(value - before[i]) > kVisible);
  }

  drawPicture(bitmap) {
    this.picture.drawImage(bitmap, 0, 0, this.stream.width_px, this.stream.height_px);
    ++this.drawings.pictures;
  }

  drawRelief(bitmap, objects, changed, isNew) {
    const resized = this.relief.resized;
    if (resized) this.fitRelief();
    if (bitmap && (changed.picture || isNew)) this.renderer.setPicture(bitmap);
    if (changed.reliefs || isNew) this.renderer.setReliefs(objects);
    if (!(changed.picture || changed.reliefs || isNew || resized) || !this.relief.size_px) return;
    this.renderer.draw(this.stream, computeScale(this.stream), this.camera);
    ++this.drawings.reliefs;
  }

  /// A turn changes only the camera: a canvas that gets its size anew is expensive.
  fitRelief() {
    const {element, size_px} = this.relief;
    const isSame = size_px?.[0] === element.clientWidth && size_px?.[1] === element.clientHeight;
    if (!isSame) return this.relief.fit(this.stream, true);
    this.camera.fit(this.stream, ...size_px);
    this.relief.resized = false;
    this.relief.dirty = true;
  }

  drawOverlay(pane, touch) {
    if (!pane.dirty && !this.touched) return;
    pane.dirty = false;
    pane.clear();
    if (touch && pane.size_px) drawTouch(pane.g, pane.view, touch.report, touch.target);
    ++this.drawings.overlays;
  }
}
