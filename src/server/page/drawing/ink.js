// SPDX-License-Identifier: MIT
// Strokes, their bursts, and where they are predicted to be felt.
import {state, current_take} from "../state.js";
import {colour, is_dark, font} from "../look.js";
import {array, view, layers, start_layer, trace_rows, disc, to_px} from "./view.js";
import {editable, shape} from "../takes/stroke.js";
import {place_labels, number_place, draw_labels} from "./labels.js";
import {draw_felt_points} from "./felt.js";
import {viridis} from "../../../net/page/viridis.js";

export function draw_ink() {
  const p = start_layer(layers.ink);
  if (!array) return;
  const take = current_take(), plan = state.compare?.blind ? null : state.plan;
  const drawing = state.drawing;
  // Tactors are the ground of the lines, which stay above them.
  place_labels(drawing ? [] : take?.strokes ?? []);
  array.places.forEach((q, i) => draw_ring(p, q, i));
  if (plan) draw_felt(p, plan);
  const strokes = drawing ? drawing.before : take?.strokes ?? [];
  strokes.forEach((s, i) => draw_stroke(p, s, i === state.stroke || drawing !== null));
  if (plan) draw_dots(p, plan);
  if (!drawing) strokes.forEach((s, i) => draw_marks(p, s, i));
  draw_labels(p, drawing || state.placing ? [] : strokes);
}
function draw_ring(p, q, i) {
  const c = to_px(q), r = array.radius * view.scale;
  disc(p, c, r);
  p.fillStyle = colour("skin");
  p.fill();
  p.strokeStyle = colour(i === state.hot ? "ink" : "ink3");
  p.lineWidth = i === state.hot ? 2.5 : 1.5;
  p.stroke();
  draw_number(p, i, "ink");
}
// Writes a tactor's number: under strokes and points, and over its disc while it is driven.
export function draw_number(p, i, tone) {
  const [x, y] = number_place(i);
  p.font = font(Math.max(11, Math.min(16, array.radius * view.scale * 0.5)), 600);
  p.textAlign = "center";
  p.textBaseline = "middle";
  p.fillStyle = colour(tone);
  const number = String(array.tactors[i].tactor ?? i);
  if (!state.placing && p.measureText(number).width < 2 * array.radius * view.scale) p.fillText(number, x, y + 0.5);
  p.textBaseline = "alphabetic";
}
function draw_felt(p, plan) {
  p.save();
  p.globalAlpha = is_dark() ? 0.5 : 0.45;
  p.strokeStyle = colour("felt");
  p.lineWidth = Math.min(9, Math.max(5, view.scale * 0.8));
  for (const rows of plan.felt_rows) { trace_rows(p, rows); p.stroke(); }
  p.restore();
  // The ribbon of the other method is hollow.
  for (const rows of state.compare?.rest?.felt_rows ?? []) for (const [tone, width] of [["felt", 8], ["skin", 5]]) {
    trace_rows(p, rows); p.strokeStyle = colour(tone); p.lineWidth = width; p.stroke();
  }
}
function draw_stroke(p, s, own) {
  if (own && shape(s) && shape(s) !== "drawn") draw_ghost(p, s.ink);
  trace_rows(p, s.timed);
  p.strokeStyle = own ? colour("ink") : colour("ink2");
  p.lineWidth = own ? 2 : 1.5;
  p.stroke();
}
// Draws the ink below a path that has left it.
function draw_ghost(p, ink) {
  trace_rows(p, ink);
  p.globalAlpha = 0.2;
  p.strokeStyle = colour("ink");
  p.lineWidth = 3;
  p.stroke();
  p.globalAlpha = 1;
}
function draw_dots(p, plan) {
  if (plan.continuous || !plan.onsets) return;
  const n = plan.onsets.length, size = Math.min(6, Math.max(2.2, view.scale * 0.55)), many = n > 1200;
  p.lineWidth = 1;
  let last = [-1e9, 0];
  for (let i = 0; i < n; ++i) {
    const c = to_px([plan.positions[2 * i], plan.positions[2 * i + 1]]);
    if (many && Math.hypot(c[0] - last[0], c[1] - last[1]) < size) continue;
    last = c;
    disc(p, c, size);
    p.fillStyle = viridis(plan.onsets[i] / (plan.total_s || 1), is_dark());
    p.fill();
    p.strokeStyle = is_dark() ? "#eceeef61" : "#17181a61";
    p.stroke();
  }
}
function draw_marks(p, s, i) {
  if (i === state.stroke && state.tool === "felt") draw_felt_points(p, s);
  if (i === state.stroke && state.tool === "points") editable(s).knots.forEach((k, n) => draw_knot(p, k, n === state.knot));
}
function draw_knot(p, k, chosen) {
  const [x, y] = to_px([k.x, k.y]), r = 6.5;
  p.beginPath();
  if (k.corner) p.rect(x - r * 0.9, y - r * 0.9, r * 1.8, r * 1.8); else p.arc(x, y, r, 0, 2 * Math.PI);
  p.fillStyle = chosen ? colour("ink") : colour("raised");
  p.fill();
  p.strokeStyle = colour("ink");
  p.lineWidth = 2;
  p.stroke();
}
