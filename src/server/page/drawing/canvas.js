// SPDX-License-Identifier: MIT
// The picture of the array at one moment: drives and felt places, over ground and strokes.
import {state, current_take, ceiling_dbfs, take_gain, is_simulated, now_ms} from "../state.js";
import {by_id} from "../../../net/page/dom.js";
import {paint, write, disc} from "../look.js";
import {interpolate} from "../takes/stroke.js";
import {distance} from "../geometry.js";
import {array, view, layers, stale, start_layer, trace, trace_rows, to_px} from "./view.js";
import {draw_ground} from "./ground.js";
import {draw_ink, draw_number} from "./ink.js";
import {draw_share, number_place} from "./labels.js";

const pen = by_id("field").getContext("2d");

// Returns each tactor's part of full amplitude at this moment: measured, or planned if nothing is driven.
function shares() {
  const t = array?.places.length ?? 0, out = new Array(t).fill(0);
  if (state.dbfs.some(v => v !== null)) {
    state.dbfs.forEach((v, i) => { if (v !== null) out[i] = Math.min(1, 10 ** ((v - ceiling_dbfs()) / 20)); });
    return out;
  }
  const plan = state.plan;
  if (!plan?.onsets?.length || (state.playing?.felt && !state.playing.waits)) return out;
  if (!shows_moment()) return out;
  const level = take_gain();
  for (const i of bursts_at(plan, state.at_s)) for (let k = 0; k < t; ++k) out[k] = Math.max(out[k],
    Math.min(1, plan.amplitudes[i * t + k] * level));
  return out;
}
// Returns the bursts that sound at a moment. Bursts of one stroke come by onset.
function bursts_at(plan, t) {
  const found = [];
  for (const s of plan.strokes) {
    let low = s.first, high = s.first + s.count;
    while (low < high) { const mid = (low + high) >> 1; if (plan.onsets[mid] <= t) low = mid + 1; else high = mid; }
    for (let i = low - 1; i >= s.first && i >= low - 12; --i) if (plan.onsets[i] + plan.durations[i] > t) found.push(i);
  }
  return found;
}
// Returns true if the canvas shows a moment: one that was chosen, or at which this take plays. For another take it shows only drives.
const shows_moment = () => state.at_s > 0 || state.playing?.take === state.current;
// Returns the places where the strokes are felt at a moment.
const felt_at = (plan, t) => (plan?.felt_rows ?? []).filter(rows => rows.length && t >= rows[0][0] && t <= rows.at(-1)[0] + 0.1)
  .map(rows => interpolate(rows, t));

export function draw_frame() {
  if (!view.width) return;
  if (stale.ground) { draw_ground(); stale.ground = false; }
  if (stale.ink) { draw_ink(); stale.ink = false; }
  start_layer(layers.moment);
  if (!array || state.compare?.blind) return;
  const now = shares();
  draw_fingers();
  draw_arms(now);
  array.places.forEach((q, i) => draw_disc(q, i, now[i]));
  draw_moment();
  draw_others();
  draw_outside();
}
function draw_disc(q, i, share) {
  if (share <= 0.001) return;
  const c = to_px(q), r = array.radius * view.scale, filled = r * Math.sqrt(share) * 0.93;
  disc(pen, c, r);
  paint(pen, {line: "felt", width: 2.5});
  if (is_simulated()) for (const far of [0.3, 0.6]) {
    disc(pen, c, r * (1 + far * share));
    paint(pen, {line: "felt", width: 2.5, alpha: 0.4});
  }
  disc(pen, c, filled);
  paint(pen, {fill: "felt"});
  draw_share(pen, i, share);
  const [x, y] = number_place(i), reach = distance([x, y], c);
  draw_number(pen, i, filled > reach + Math.min(6, 0.2 * r) ? "on-felt" : "ink");
}
function draw_arms(now) {
  if (!state.plan || state.drawing) return;
  const places = felt_at(state.plan, state.at_s);
  if (!places.length || !shows_moment()) return;
  for (const f of places) now.forEach((share, i) => {
    if (share < 0.01) return;
    trace(pen, [[f[1], f[2]], array.places[i]]);
    paint(pen, {line: "felt", width: 1 + 7 * share, alpha: 0.35});
  });
}
// Draws the target of this moment as a ring, and its felt place as a dot.
function draw_moment() {
  const take = current_take();
  if (!take || state.drawing || !shows_moment()) return;
  for (const s of take.strokes) {
    const t = state.at_s - s.start_s;
    if (t < 0 || t > s.timed.at(-1)[0]) continue;
    disc(pen, to_px(interpolate(s.timed, t).slice(1)), 11);
    paint(pen, {line: "skin", width: 5});
    paint(pen, {line: "ink", width: 2.5});
  }
  for (const f of felt_at(state.plan, state.at_s)) felt_dot(to_px([f[1], f[2]]));
}
function felt_dot(c) {
  disc(pen, c, 7);
  paint(pen, {fill: "felt", line: "skin", width: 2});
}
function draw_fingers() {
  for (const k of state.drawing?.tracks ?? []) {
    trace_rows(pen, k.points);
    paint(pen, {line: "ink", width: 2.5});
    if (k.down) felt_dot(to_px(k.points.at(-1).slice(1, 3)));
  }
}
function draw_others() {
  for (const [id, t] of state.touches) {
    if (now_ms() - t.at > 3000) { state.touches.delete(id); continue; }
    const c = to_px([t.x_mm, t.y_mm]);
    disc(pen, c, 13);
    paint(pen, {line: "info", width: 3});
    const who = state.status?.who?.find(w => w.client === t.client)?.name;
    if (who) write(pen, `“${who}”`, c[0], c[1] - 20, "info", {weight: 600});
  }
}
// Draws a mark where the end of a stroke lies beyond the array.
function draw_outside() {
  for (const w of state.outside) {
    const [x, y] = to_px(w.place).map((v, k) => Math.min((k ? view.height : view.width) - 14, Math.max(14, v)));
    disc(pen, [x, y], 11);
    paint(pen, {fill: "warn-ground", line: "warn", width: 1.5});
    write(pen, "!", x, y + 4.5, "warn", {size: 13, weight: 700});
  }
}
// Returns true while frames differ although nothing was changed.
export const moves = () => state.playing !== null || state.drawing !== null || state.touches.size > 0
  || state.dbfs.some(v => v !== null);
