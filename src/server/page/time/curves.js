// SPDX-License-Identifier: MIT
// Speed and strength along the strokes, requested and felt, and the points that change them.
import {state, changed, current_take, current_stroke} from "../state.js";
import {paint, write, plot} from "../look.js";
import {left, right, to_x} from "./time_axis.js";
import {edit_stroke} from "../takes/takes.js";
import {clamp, distance, sampled} from "../geometry.js";
import {editable, rebuild, interpolate, duration_s, find_speeds, length_mm, parts_reached, kept_for} from "../takes/stroke.js";

const FELT_STEP_S = 0.07; // the SOA of the paper

// Draws requested and felt speed, and strength with its points.
export function draw_curves(p, l) {
  const take = current_take(), top = l.height - l.curves, bottom = l.height - 8;
  if (!take?.strokes.length || !l.curves) return;
  const most = most_speed(take), y_speed = v => bottom - Math.min(1, v / most) * (bottom - top - 12);
  plot(p, [left(l), bottom + 0.5], [l.width - right(l), bottom + 0.5]);
  paint(p, {line: "line2"});
  const letters = {size: 11, align: "right"};
  write(p, `${Math.round(most)} mm/s`, l.width - 4, top + 16, "ink3", letters);
  write(p, "0", l.width - 4, bottom, "ink3", letters);
  [["speed", "ink"], ["as felt", "felt-ink"], ["strength", "ink2"]].forEach(([name, tone], i) => write(p, name, left(l) - 8, top + 16 + 15 * i, tone, letters));
  take.strokes.forEach((s, i) => {
    draw_speed(p, l, s, i, y_speed);
    draw_strength(p, l, s, top, bottom);
  });
  draw_handles(p, l);
}
const speed_rows = kept_for(timed => {
  const d = timed.at(-1)[0], n = clamp(Math.round(d / 0.03), 8, 160);
  return Array.from({length: n}, (_, i) => {
    const middle = d * (i + 0.5) / n, half = Math.min(d / n, FELT_STEP_S) / 2;
    const a = interpolate(timed, middle - half), b = interpolate(timed, middle + half);
    return [middle, distance(a.slice(1), b.slice(1)) / (2 * half)];
  });
});
function most_speed(take) {
  const asked = Math.max(1, ...take.strokes.flatMap(s => speed_rows(s.timed).map(r => r[1])));
  const felt = felt_speeds(state.plan).flat().map(r => r[1]).sort((a, b) => a - b);
  return Math.ceil(Math.max(asked * 1.25, felt[Math.floor(felt.length * 0.97)] ?? 0) / 10) * 10;
}
const speeds_felt = kept_for(plan => plan.felt_rows.map(felt => {
    const found = [];
    if (felt.length < 2) return found;
    // Steps go from middle to middle, because nothing moves within a burst.
    const step = Math.max(FELT_STEP_S, (felt.at(-1)[0] - felt[0][0]) / 400);
    for (let t = felt[0][0] + step / 2; t + step < felt.at(-1)[0]; t += step) {
      const a = interpolate(felt, t), b = interpolate(felt, t + step);
      found.push([t + step / 2, distance(a.slice(1), b.slice(1)) / step]);
    }
    return found;
  }));
const felt_speeds = plan => plan ? speeds_felt(plan) : [];
// The curve that is touched stands out, and has its points.
const alpha = kind => !state.curve || state.curve === kind ? 1 : 0.3;
export function touch_curve(kind) {
  if (state.curve === kind) return;
  state.curve = kind;
  changed("curves");
}
function draw_speed(p, l, s, i, y) {
  const line = (rows, from, tone) => {
    plot(p, ...rows.map(([t, v]) => [to_x(l, from + t), y(v)]));
    paint(p, {line: tone, width: 1.5, alpha: alpha("speed")});
  };
  line(felt_speeds(state.plan)[i] ?? [], 0, "felt");
  line(speed_rows(s.timed), s.start_s, "ink");
}
// Returns the points that can be dragged, {x, y, kind, index}: first those of the curve that is touched.
export function handles(l) {
  const s = current_stroke();
  if (!s || !l.curves) return [];
  const e = editable(s), d = duration_s(s), top = l.height - l.curves, bottom = l.height - 8, found = [];
  const mean = length_mm(s.timed) / d, most = most_speed(current_take());
  find_speeds(e.pace).forEach(([part, v], index) => found.push({kind: "speed", index,
    x: to_x(l, s.start_s + d * reached(e, part)), y: y_strength(Math.min(1, v * mean / most), top, bottom), mean, most}));
  strength_points(e).forEach(([part, v], index) => found.push({kind: "strength", index,
    x: to_x(l, s.start_s + d * reached(e, part)), y: y_strength(v, top, bottom)}));
  return found.sort((a, b) => (b.kind === state.curve) - (a.kind === state.curve));
}
const strength_points = s => s.strength.length >= 3 && s.strength.length <= 12 ? s.strength
  : s.strength.length < 3 ? [s.strength[0], [0.5, interpolate(s.strength, 0.5)[1]], s.strength.at(-1)]
  : [0, 0.25, 0.5, 0.75, 1].map(part => [part, interpolate(s.strength, part)[1]]);
const y_strength = (v, top, bottom) => bottom - v * (bottom - top - 12);
// Returns the part of the time at which a part of the path is reached.
const reached = (s, part) => interpolate(s.pace.kind === "even" ? [[0, 0], [1, 1]] : parts_reached(s.timed), part)[1];
function draw_strength(p, l, s, top, bottom) {
  const rows = s.timed.length > 400 ? sampled(200, part => interpolate(s.timed, duration_s(s) * part)) : s.timed;
  plot(p, ...rows.map(q => [to_x(l, s.start_s + q[0]), y_strength(Math.min(1, q[3] ?? 1), top, bottom)]));
  p.setLineDash([1, 4]);
  paint(p, {line: "ink2", width: 2, alpha: alpha("strength")});
  p.setLineDash([]);
}
function draw_handles(p, l) {
  for (const h of handles(l)) {
    if (h.kind !== state.curve) return;
    p.beginPath();
    if (h.kind === "speed") p.rect(h.x - 4, h.y - 4, 8, 8); else p.arc(h.x, h.y, 5, 0, 7);
    paint(p, {fill: "panel", line: "ink2", width: 1.75});
  }
}

export function set_strength(index, v, key) {
  edit_stroke(s => rebuild({...s, strength: strength_points(s).map((q, i) => i === index ? [q[0], +v.toFixed(3)] : q)}), key);
}
export const strengths = () => strength_points(editable(current_stroke()));
export function set_speed(index, v, key) {
  edit_stroke(s => rebuild({...s, pace: {kind: "points", speeds: find_speeds(s.pace).map((q, i) => i === index ? [q[0], v] : q)}}), key);
}
