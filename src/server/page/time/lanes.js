// SPDX-License-Identifier: MIT
// Lanes that show the times at which tactors play: a ruler, the strokes, a lane for each tactor. They are drawn only
// when something has changed; the mark of the time shown is an element above them.
import {state, current_take, marks} from "../state.js";
import {colour, is_dark, paint, write, plot} from "../look.js";
import {array} from "../drawing/view.js";
import {viridis} from "../../../net/page/viridis.js";
import {full, mini, total, shown, left, right, to_x, lane_tactors, silent_count} from "./time_axis.js";
import {lane_height, most_scroll, draw_time_marks, LEAST_AMPLITUDE, CLIP} from "./time_axis.js";
import {draw_curves} from "./curves.js";
import {place_clips} from "./clips.js";
import {end_s} from "../takes/stroke.js";
import {look_at} from "../service/player.js";
import {seconds_text} from "../words.js";
import {algorithm} from "../takes/takes.js";

const STEPS_S = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120]; // steps of the ruler

function draw_lane(l) {
  const p = l.canvas.getContext("2d");
  p.setTransform(l.dpr, 0, 0, l.dpr, 0, 0);
  p.clearRect(0, 0, l.width, l.height);
  p.lineJoin = p.lineCap = "round";
  if (!array) return;
  const lanes = lane_tactors(), h = lane_height(l), end = l.width - right(l), most = most_scroll(l);
  l.scroll = Math.min(l.scroll, most);
  const top = l.top - l.scroll;
  if (!l.thin && total()) draw_ruler(p, l, l.bottom);
  p.save();
  p.beginPath(); p.rect(0, l.top - 2, l.width, l.bottom - l.top + 2); p.clip();
  lanes.forEach((i, row) => {
    const y = top + (row + 1) * h;
    if (l.thin) { p.fillStyle = colour("well"); p.fillRect(left(l), y - h * 0.8, end - left(l), Math.max(1, h * 0.6)); return; }
    const hot = i === state.hot, tone = hot ? "ink" : "ink2", number = String(i);
    plot(p, [left(l), y - 0.5], [end, y - 0.5]);
    paint(p, {line: hot ? "ink2" : "grid"});
    write(p, number, left(l) - 8, y - 2, tone, {weight: hot ? 700 : 600, align: "right"});
    if (row === 0) write(p, "tactor", left(l) - 12 - p.measureText(number).width, y - 2, tone, {size: 11, align: "right"});
  });
  if (silent_count() && !l.thin) write(p, `${silent_count()} of ${array.places.length} are silent; the others are in the order in which they begin`,
    left(l), top + (lanes.length + 1) * h - 4, "ink3", {align: "left"});
  if (state.plan) draw_bars(p, l, h, top, lanes);
  p.restore();
  if (most && !l.thin) {
    const room = l.bottom - l.top;
    p.beginPath(); p.roundRect(l.width - 9, l.top + room * l.scroll / (most + room), 4, room * room / (most + room), 2);
    paint(p, {fill: "ink3"});
  }
  if (!l.mini && !state.drawing) { draw_gaps(p, l); draw_curves(p, l); }
  draw_time_marks(p, l);
  if (!l.mini) place_clips(l);
}
function draw_ruler(p, l, bottom) {
  const s = shown(l), step = STEPS_S.find(v => v / s * (l.width - left(l) - right(l)) > 58) ?? 300;
  for (let i = Math.ceil(l.from / step); i * step <= l.from + s; ++i) {
    const x = to_x(l, i * step);
    plot(p, [x, l.ruler + CLIP], [x, bottom]);
    paint(p, {line: "grid"});
    if (marks().range?.some(t => Math.abs(to_x(l, t) - x) < 26)) continue;
    write(p, `${(i * step).toFixed(step < 0.1 ? 2 : step < 1 ? 1 : 0)}${i === 0 ? " s" : ""}`, x, 12, "ink2", {size: 11});
  }
  const until = to_x(l, Math.min(total(), l.from + s)), from = to_x(l, l.from);
  const g = p.createLinearGradient(to_x(l, 0), 0, to_x(l, total()), 0);
  for (let k = 0; k <= 8; ++k) g.addColorStop(k / 8, viridis(k / 8, is_dark()));
  p.fillStyle = g;
  p.beginPath(); p.roundRect(from, 18, Math.max(1, until - from), 5, 2.5); p.fill();
}
function draw_bars(p, l, h, top, lanes) {
  const plan = state.plan, t = plan.tactors, n = plan.onsets.length, row = new Map(lanes.map((k, i) => [k, i]));
  const from = l.from, to = l.from + shown(l), all = plan.total_s || 1, is_brush = algorithm() === "tactile-brush";
  // Draws the largest burst of each pixel if bursts are narrower than a pixel.
  const rows = !plan.continuous && l.width / n < 1.5 && merged_rows(l, plan, t);
  const one = (onset, seconds, k, a) => {
    if (a < LEAST_AMPLITUDE) return;
    const x = to_x(l, onset), w = Math.max(0.75, to_x(l, onset + seconds) - x), y = top + (row.get(k) + 1) * h;
    p.fillStyle = viridis(onset / all, is_dark());
    if (l.thin) { p.globalAlpha = 0.25 + 0.75 * Math.min(1, a);
      p.fillRect(x, y - h * 0.8, w - (w > 3 ? 0.5 : 0), Math.max(1, h * 0.6)); p.globalAlpha = 1; return; }
    const tall = Math.min(1, a) * (h - 3), ramp = Math.min(w * 0.2, 6);
    if (is_brush) {
      plot(p, [x, y - 1], [x + ramp, y - 1 - tall], [x + w - ramp, y - 1 - tall], [x + w, y - 1]);
      return p.fill();
    }
    p.fillRect(x, y - 1 - tall, w - (w > 3 && !plan.continuous ? 0.75 : -0.3), tall);
    if (w > 4 && tall > 5 && !plan.continuous) {
      plot(p, [x, y - 0.5 - tall], [x + w - 0.75, y - 0.5 - tall]);
      paint(p, {line: "ink", alpha: 0.38});
    }
  };
  if (rows) return rows.forEach(r => one(...r));
  for (let i = 0; i < n; ++i) {
    if (plan.onsets[i] > to || plan.onsets[i] + plan.durations[i] < from) continue;
    for (let k = 0; k < t; ++k) one(plan.onsets[i], plan.durations[i], k, plan.amplitudes[i * t + k]);
  }
}
function merged_rows(l, plan, t) {
  const bins = new Map(), width = shown(l) / (l.width - left(l) - right(l));
  for (let i = 0; i < plan.onsets.length; ++i) {
    const at = plan.onsets[i], bin = Math.floor((at - l.from) / width);
    if (at < l.from || at > l.from + shown(l)) continue;
    for (let k = 0; k < t; ++k) {
      const a = plan.amplitudes[i * t + k], key = bin * t + k;
      if (a > (bins.get(key) ?? 0)) bins.set(key, a);
    }
  }
  return [...bins].map(([key, a]) => [l.from + Math.floor(key / t) * width, width * 1.4, key % t, a]);
}
// Writes the length of the silence before a stroke.
function draw_gaps(p, l) {
  const strokes = current_take()?.strokes ?? [];
  strokes.forEach((s, i) => {
    const before = strokes.filter((_, k) => k !== i).map(end_s).filter(e => e <= s.start_s + 1e-9);
    const gap = before.length ? s.start_s - Math.max(...before) : 0;
    if (gap > 0.005 && to_x(l, gap) - to_x(l, 0) >= 34) write(p, `${gap.toFixed(2)} s`, to_x(l, s.start_s - gap / 2), l.ruler + 15, "ink3", {size: 11});
  });
}

export function draw_lanes() {
  for (const l of [full, mini]) {
    if (!l.width || !l.height || state.drawing && !l.stale) continue; // each plan of a drawing makes it longer
    if (l.stale) { draw_lane(l); l.stale = false; }
    const x = to_x(l, state.drawing ? total() : state.at_s);
    l.moment.style.translate = `${x}px`;
    l.moment.hidden = x < left(l) - 1 || x > l.width - right(l) + 20;
  }
  // Scrolls so that the current moment stays visible.
  if (state.playing && full.span && !full.held_s && (state.at_s > full.from + full.span * 0.95
    || state.at_s < full.from)) { full.from = Math.max(0, state.at_s - full.span * 0.1); full.stale = true; }
}
// Goes to the next or the previous burst.
export function step_burst(by) {
  const onsets = [...(state.plan?.onsets ?? [])].sort((a, b) => a - b);
  const next = by > 0 ? onsets.find(t => t > state.at_s + 1e-4) : onsets.filter(t => t < state.at_s - 1e-4).pop();
  if (next !== undefined) look_at(next + 1e-4);
}
export const clock_text = () => [state.drawing ? total().toFixed(2) : state.at_s.toFixed(2), seconds_text(total())];
