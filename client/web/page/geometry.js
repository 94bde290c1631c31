// SPDX-License-Identifier: MIT
// Nominal frame, picture and views.
// Nominal: mm, origin in the picture's centre, x right, y up, z towards the viewer.
// A view converts a nominal position to a point on the screen (CSS px) and a point to a ray.
// FlatView looks along z. Camera looks from the side: it turns the picture by yaw about z, then by
// pitch about the screen's horizontal axis, and projects with perspective.

export const kTowardsViewer = [0.35, -0.75];  // drawn direction of z in the flat picture
const kArrowShare = 0.09;                     // share of the picture's width for 1 N
const kLeastProjection = 0.05;                // a force with a shorter projection is drawn along z

export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
export const norm = ([x, y, z]) => Math.hypot(x, y, z);

/// Returns mm per px of the stream's picture in x and in y.
export function computeScale(stream) {
  const sx = stream.width_mm / stream.width_px;
  const sy = stream.height_mm / stream.height_px;
  return stream.stretch ? [sx, sy] : [Math.min(sx, sy), Math.min(sx, sy)];
}

/// Returns the arrow of a force in the flat picture, px: 1 N has the same length in every
/// direction.
export function computeArrow(force_N, width_px) {
  const size_N = norm(force_N);
  let x = force_N[0] + kTowardsViewer[0] * force_N[2];
  let y = -force_N[1] + kTowardsViewer[1] * force_N[2];
  let length = Math.hypot(x, y);
  if (!(length > kLeastProjection * size_N)) {
    [x, y] = kTowardsViewer;
    length = Math.hypot(x, y);
  }
  const factor = kArrowShare * width_px * size_N / length;
  return [factor * x, factor * y];
}

/// Returns the height of the reliefs at a position, nominal mm; null beside all objects.
export function findHeight_mm(stream, objects, x_mm, y_mm) {
  const [sx, sy] = computeScale(stream);
  const px = x_mm / sx + stream.width_px / 2;
  const py = stream.height_px / 2 - y_mm / sy;
  let height_mm = null;
  for (const object of objects) {
    const column = Math.round((px - object.u - 0.5) / object.step);
    const row = Math.round((py - object.v - 0.5) / object.step);
    if (column < 0 || row < 0 || column >= object.columns || row >= object.rows) continue;
    const here_mm = object.heights[row * object.columns + column];
    if (here_mm > (height_mm ?? -Infinity)) height_mm = here_mm;
  }
  return height_mm;
}

/// The flat picture in the middle of a rectangle, as large as possible.
export class FlatView {
  flat = true;

  fit(stream, width_px, height_px) {
    [this.sx, this.sy] = computeScale(stream);
    this.zoom = Math.min(width_px / stream.width_px, height_px / stream.height_px);
    this.width_px = stream.width_px * this.zoom;
    this.height_px = stream.height_px * this.zoom;
    this.left = (width_px - this.width_px) / 2;
    this.top = (height_px - this.height_px) / 2;
    this.pxPerMm = this.zoom / this.sx;
  }

  project(x_mm, y_mm) {
    return [
      clamp(
          this.left + this.width_px / 2 + x_mm / this.sx * this.zoom, this.left,
          this.left + this.width_px),
      clamp(
          this.top + this.height_px / 2 - y_mm / this.sy * this.zoom, this.top,
          this.top + this.height_px),
    ];
  }

  arrow(_from_mm, force_N) { return computeArrow(force_N, this.width_px); }

  /// Returns the nominal x and y under a point; null beside the picture.
  pick(x, y) {
    const u = (x - this.left - this.width_px / 2) / this.zoom;
    const v = (y - this.top - this.height_px / 2) / this.zoom;
    if (Math.abs(x - this.left - this.width_px / 2) > this.width_px / 2 ||
        Math.abs(y - this.top - this.height_px / 2) > this.height_px / 2)
      return null;
    return [u * this.sx, -v * this.sy];
  }
}

/// The relief from the side.
export class Camera {
  flat = false;
  yaw_rad = -0.35;  // chosen: from the left, so that all axes are visible
  pitch_rad = 0.7;
  kForce_mm_per_N = 12;  // length of the arrow, as in the native window

  turn(yaw_rad, pitch_rad) {
    this.yaw_rad = (this.yaw_rad + yaw_rad) % (2 * Math.PI);
    this.pitch_rad = clamp(this.pitch_rad + pitch_rad, 0, 1.4);  // never from behind
  }

  /// Fits the box of picture and depth into a rectangle of the screen.
  fit(stream, width_px, height_px) {
    const [sx, sy] = computeScale(stream);
    const x_mm = stream.width_px * sx / 2;
    const y_mm = stream.height_px * sy / 2;
    this.turned = [
      Math.cos(this.yaw_rad), Math.sin(this.yaw_rad), Math.cos(this.pitch_rad),
      Math.sin(this.pitch_rad)
    ];
    this.eye_mm = 5 * x_mm;
    this.middle_mm = stream.depth_mm / 2;
    this.most_mm = stream.depth_mm + 5;
    Object.assign(this, {zoom: 1, left: 0, top: 0});
    let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (let i = 0; i < 8; ++i) {
      const at =
          this.project(i & 1 ? x_mm : -x_mm, i & 2 ? y_mm : -y_mm, i & 4 ? stream.depth_mm : 0);
      low = low.map((value, k) => Math.min(value, at[k]));
      high = high.map((value, k) => Math.max(value, at[k]));
    }
    this.zoom = 0.94 * Math.min(width_px / (high[0] - low[0]), height_px / (high[1] - low[1]));
    this.left = width_px / 2 - this.zoom * (low[0] + high[0]) / 2;
    this.top = height_px / 2 - this.zoom * (low[1] + high[1]) / 2;
    this.width_px = width_px;
    this.height_px = height_px;
    this.pxPerMm = this.zoom;
  }

  project(x_mm, y_mm, z_mm) {
    const [cosYaw, sinYaw, cosPitch, sinPitch] = this.turned;
    const x = cosYaw * x_mm - sinYaw * y_mm;
    const y = sinYaw * x_mm + cosYaw * y_mm;
    const z = z_mm - this.middle_mm;
    const w = 1 - (z * cosPitch - y * sinPitch) / this.eye_mm;
    return [
      this.left + this.zoom * x / w, this.top - this.zoom * (y * cosPitch + z * sinPitch) / w
    ];
  }

  arrow(from_mm, force_N) {
    const [x, y] = this.project(...from_mm);
    const end = this.project(...from_mm.map((at, i) => at + this.kForce_mm_per_N * force_N[i]));
    return [end[0] - x, end[1] - y];
  }

  /// Returns the nominal position on the line of sight through a point at a height; null if the
  /// line does not reach this height.
  reach(x, y, z_mm) {
    const [cosYaw, sinYaw, cosPitch, sinPitch] = this.turned;
    const a = (x - this.left) / this.zoom;
    const b = (this.top - y) / this.zoom;
    const z = z_mm - this.middle_mm;
    // The line of sight is (a w, b w) with w = 1 - (z cosPitch - v sinPitch) / eye, where v is the
    // place along the turned y axis: b w = v cosPitch + z sinPitch.
    const divisor = cosPitch - b * sinPitch / this.eye_mm;
    if (divisor < 0.05) return null;
    const v = (b * (1 - z * cosPitch / this.eye_mm) - z * sinPitch) / divisor;
    const u = a * (1 - (z * cosPitch - v * sinPitch) / this.eye_mm);
    return [cosYaw * u + sinYaw * v, cosYaw * v - sinYaw * u];
  }

  /// Returns x and y of the first surface on the line of sight through a point; null beside the
  /// picture.
  pick(x, y, stream, objects) {
    const kStep_mm = 0.5;  // chosen: finer than a hand's aim
    for (let z_mm = stream.depth_mm; z_mm > 0; z_mm -= kStep_mm) {
      const at = this.reach(x, y, z_mm);
      if (at && (findHeight_mm(stream, objects, ...at) ?? 0) >= z_mm) return at;
    }
    const at = this.reach(x, y, 0);
    const [sx, sy] = computeScale(stream);
    const isInside = at && Math.abs(at[0]) <= stream.width_px * sx / 2 &&
        Math.abs(at[1]) <= stream.height_px * sy / 2;
    return isInside ? at : null;
  }
}
