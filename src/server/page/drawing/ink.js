// SPDX-License-Identifier: MIT
// Strokes, their bursts, and their predicted felt places.
import {state, current_take} from "../state.js";
import {colour, is_dark, font, paint, disc} from "../look.js";
import {array, view, layers, start_layer, trace_rows, to_px} from "./view.js";
import {clamp, distance} from "../geometry.js";
import {editable, shape} from "../takes/stroke.js";
import {place_labels, number_place, draw_labels} from "./labels.js";
import {draw_felt_points, felt_points} from "./felt.js";
import {viridis} from "../../../net/page/viridis.js";

export function draw_ink() {
  const p = start_layer(layers.ink);
  if (!array) return;
  const {drawing, stroke} = state, plan = state.compare?.blind ? null : state.plan, strokes = drawing ? drawing.before : current_take()?.strokes ?? [];
  // Draws the tactors below the lines, which stay visible, and their numbers above.
  place_labels(drawing ? [] : strokes, drawing || !strokes[stroke] ? [] : mark_places(strokes[stroke]));
  array.places.forEach((q, i) => draw_ring(p, q, i));
  if (plan) draw_felt(p, plan);
  strokes.forEach((s, i) => draw_stroke(p, s, i === stroke || drawing !== null));
  if (plan) draw_dots(p, plan);
  if (!drawing && strokes[stroke]) draw_marks(p, strokes[stroke]);
  array.places.forEach((_, i) => draw_number(p, i, "ink"));
  if (drawing || !strokes[stroke]) return;
  if (!state.placing) draw_labels(p, strokes[stroke]);
}
function draw_ring(p, q, i) {
  const hot = i === state.hot;
  disc(p, to_px(q), array.radius * view.scale);
  paint(p, {fill: "skin", line: hot ? "ink" : "ink3", width: hot ? 2.5 : 1.5});
}
// Writes a tactor's number over all else. A number in ink has a rim, so that it is legible on strokes and bursts.
export function draw_number(p, i, tone) {
  const [x, y] = number_place(i), r = array.radius * view.scale, number = String(i);
  p.font = font(clamp(r * 0.5, 11, 16), 600);
  p.textAlign = "center";
  p.textBaseline = "middle";
  p.fillStyle = colour(tone);
  p.strokeStyle = colour("skin");
  p.lineWidth = 4;
  if (!state.placing && p.measureText(number).width < 2 * r) {
    if (tone === "ink") p.strokeText(number, x, y + 0.5);
    p.fillText(number, x, y + 0.5);
  }
  p.textBaseline = "alphabetic";
}
function draw_felt(p, plan) {
  const ribbon = {line: "felt", width: clamp(view.scale * 0.8, 5, 9), alpha: is_dark() ? 0.5 : 0.45};
  for (const rows of plan.felt_rows) { trace_rows(p, rows); paint(p, ribbon); }
  // Draws the ribbon of the other method hollow.
  for (const rows of state.compare?.rest?.felt_rows ?? []) {
    trace_rows(p, rows);
    paint(p, {line: "felt", width: 8});
    paint(p, {line: "skin", width: 5});
  }
}
function draw_stroke(p, s, own) {
  // Draws the ink below a path that differs from it.
  if (own && s.ink && shape(s) !== "drawn") {
    trace_rows(p, s.ink);
    paint(p, {line: "ink", width: 3, alpha: 0.2});
  }
  trace_rows(p, s.timed);
  paint(p, own ? {line: "ink", width: 2} : {line: "ink2", width: 1.5});
}
function draw_dots(p, plan) {
  if (plan.continuous) return;
  const n = plan.onsets.length, size = clamp(view.scale * 0.55, 2.2, 6), many = n > 1200;
  let last = [-1e9, 0];
  for (let i = 0; i < n; ++i) {
    const c = to_px([plan.positions[2 * i], plan.positions[2 * i + 1]]);
    if (many && distance(c, last) < size) continue;
    last = c;
    disc(p, c, size);
    p.fillStyle = viridis(plan.onsets[i] / (plan.total_s || 1), is_dark());
    p.fill();
    paint(p, {line: "ink", alpha: 0.38});
  }
}
const mark_places = s => (state.tool === "felt" ? felt_points(s) : state.tool === "points" ? editable(s).knots : []).map(q => to_px([q.x, q.y]));
function draw_marks(p, s) {
  if (state.tool === "felt") draw_felt_points(p, s);
  if (state.tool === "points") editable(s).knots.forEach((k, n) => draw_knot(p, k, n === state.knot));
}
function draw_knot(p, k, chosen) {
  const [x, y] = to_px([k.x, k.y]), r = 6.5;
  p.beginPath();
  if (k.corner) p.rect(x - r * 0.9, y - r * 0.9, r * 1.8, r * 1.8); else p.arc(x, y, r, 0, 2 * Math.PI);
  paint(p, {fill: chosen ? "ink" : "raised", line: "ink", width: 2});
}
