// SPDX-License-Identifier: MIT
// Draws the touch over the picture or over the relief: cone, contact, pointer, height and forces.
// The marks and colours are those of the native window. In contact the cone stands at the contact,
// never inside the object: so stiffness and bumps are seen as they are felt. Before contact a line
// leads from the cone to the spot that it would touch.

import {kTowardsViewer, norm} from './geometry.js';

export const kColours = {
  force: '#ffd640',
  static: '#4078ff',
  dynamic: '#ff3830',
  contact: '#5aff78',
  gap: '#bed7e6',
  cone: '#46cdbe',
  rim: '#141414',
};
const kCone_mm = 18;    // length of the cone in the flat picture
const kStylus_mm = 16;  // length and radius of the cone at the relief
const kRadius_mm = 4.5;
const kEye_mm = 120;        // distance of the eye: a nearer cone is larger
const kMostHeight_mm = 12;  // a high cone is drawn at most so far from its shadow
const kInvisible_N = 5e-3;

/// Returns the factor (0..1) between the rendered force and static plus dynamic force.
export function computeRenderedShare(report) {
  const before_N = norm(report.static_force_N.map((part, i) => part + report.dynamic_force_N[i]));
  const force_N = norm(report.force_N);
  return before_N > kInvisible_N && force_N > kInvisible_N ? Math.min(force_N / before_N, 1) : 0;
}

function line(g, from, to, width_px, colour) {
  g.beginPath();
  g.moveTo(...from);
  g.lineTo(...to);
  g.lineWidth = width_px;
  g.strokeStyle = colour;
  g.stroke();
}

function ring(g, [x, y], radius_px, colour, width_px) {
  g.beginPath();
  g.arc(x, y, radius_px, 0, 2 * Math.PI);
  g.lineWidth = width_px;
  g.strokeStyle = colour;
  g.stroke();
}

function fill(g, colour, ...corners) {
  g.beginPath();
  corners.forEach(corner => g.lineTo(...corner));
  g.closePath();
  g.fillStyle = colour;
  g.fill();
}

/// Draws an arrow with a rim, which keeps it visible on a picture of its colour.
function arrow(g, [x, y], [dx, dy], width_px, colour, dashed) {
  const length = Math.hypot(dx, dy);
  if (length < 2) return;
  const head = Math.min(length, 4 * width_px);
  const along = [dx / length, dy / length];
  const neck = [x + dx - head * along[0], y + dy - head * along[1]];
  g.setLineDash(dashed ? [3.5 * width_px, 2.5 * width_px] : []);
  for (const [rim_px, paint] of [[1, kColours.rim], [0, colour]]) {
    line(g, [x, y], neck, width_px + 2 * rim_px, paint);
    const side = 0.5 * head + 1.5 * rim_px;
    fill(
        g, paint, [x + dx + 2 * rim_px * along[0], y + dy + 2 * rim_px * along[1]],
        [neck[0] - side * along[1], neck[1] + side * along[0]],
        [neck[0] + side * along[1], neck[1] - side * along[0]]);
  }
  g.setLineDash([]);
}

/// Draws a translucent cone with its apex at `tip`, open at `top`.
function cone(g, tip, top, radius_px) {
  const length = Math.hypot(top[0] - tip[0], top[1] - tip[1]);
  const along = length > 1e-6 ? [(top[0] - tip[0]) / length, (top[1] - tip[1]) / length] : [0, -1];
  const across = [-along[1], along[0]];
  const side =
      sign => [top[0] + sign * radius_px * across[0], top[1] + sign * radius_px * across[1]];
  g.globalAlpha = 0.78;
  fill(g, kColours.cone, tip, side(1), top);
  fill(g, '#28968c', tip, top, side(-1));
  g.beginPath();
  g.ellipse(
      top[0], top[1], radius_px, 0.4 * radius_px, Math.atan2(across[1], across[0]), 0, 2 * Math.PI);
  g.fillStyle = '#78ebdc';
  g.fill();
  g.globalAlpha = 1;
}

/// Returns the points of the drawing: the spot below the tip, the tip, and the cone's opening.
function placeTip(view, report) {
  const at_mm = report.contact ? report.contact_mm : report.hip_mm;
  const surface_mm = report.over_object && report.object_present ? report.height_at_hip_mm : 0;
  const gap_mm = report.contact ? 0 : Math.max(0, report.hip_mm[2] - surface_mm);
  const isOver = report.over_object && report.object_present;
  if (!view.flat) {
    const tip = view.project(...at_mm);
    return {
      at_mm,
      tip,
      top: view.project(at_mm[0], at_mm[1], at_mm[2] + kStylus_mm),
      foot: view.project(at_mm[0], at_mm[1], report.contact ? at_mm[2] : surface_mm),
      radius_px: kRadius_mm * view.pxPerMm,
      gap_mm
    };
  }
  const foot = view.project(...at_mm);
  const drawn_mm = isOver ? gap_mm / (1 + gap_mm / kMostHeight_mm) : 0;
  const up = length_mm => kTowardsViewer.map(part => part * length_mm * view.pxPerMm);
  const [dx, dy] = up(drawn_mm);
  const tip = [foot[0] + dx, foot[1] + dy];
  const size_mm = kCone_mm * kEye_mm / Math.max(kEye_mm - at_mm[2], 0.3 * kEye_mm);
  const [cx, cy] = up(size_mm);
  return {
    at_mm,
    foot,
    tip,
    top: [tip[0] + cx, tip[1] + cy],
    radius_px: 0.24 * size_mm * view.pxPerMm,
    gap_mm: isOver ? gap_mm : 0
  };
}

function drawGap(g, {foot, tip}, unit) {
  line(g, tip, foot, 3 * unit, kColours.rim);
  line(g, tip, foot, 1.5 * unit, kColours.gap);
  g.beginPath();
  g.ellipse(foot[0], foot[1], 8 * unit, 4 * unit, 0, 0, 2 * Math.PI);
  g.fillStyle = 'rgba(10, 10, 10, 0.75)';
  g.fill();
  g.lineWidth = 1;
  g.strokeStyle = kColours.gap;
  g.stroke();
}

/// Draws the touch of `report` into the context `g` of a cleared canvas. `target` is the pointer's
/// place.
export function drawTouch(g, view, report, target) {
  const unit = Math.max(0.8, view.width_px / 960);
  const parts = placeTip(view, report);
  const goal = view.project(target.x_mm, target.y_mm, view.flat ? 0 : parts.at_mm[2]);
  line(g, goal, parts.foot, 1, '#bebebe');
  ring(g, goal, 6 * unit, kColours.rim, 4);
  ring(g, goal, 6 * unit, '#fff', 2);
  if (parts.gap_mm > 0) drawGap(g, parts, unit);
  cone(g, parts.tip, parts.top, parts.radius_px);
  if (report.contact) {
    ring(g, parts.tip, 8 * unit, kColours.rim, 5);
    ring(g, parts.tip, 8 * unit, kColours.contact, 3);
  }
  const show = (force_N, width_px, colour, dashed) => {
    if (norm(force_N) > kInvisible_N)
      arrow(g, parts.tip, view.arrow(parts.at_mm, force_N), width_px, colour, dashed);
  };
  show(report.force_N, 7 * unit, kColours.force, false);
  const share = computeRenderedShare(report);
  show(report.static_force_N.map(part => share * part), 2.5 * unit, kColours.static, true);
  show(report.dynamic_force_N.map(part => share * part), 2.5 * unit, kColours.dynamic, true);
  g.beginPath();
  g.arc(...parts.tip, 3.5 * unit, 0, 2 * Math.PI);
  g.fillStyle = '#fff';
  g.fill();
}
