// SPDX-License-Identifier: MIT
// Pointers and keys on the timelines: look at a moment, move and trim clips, drag points of speed and strength.
import {state, changed, current_take} from "../state.js";
import {put_stroke, end_edit} from "../takes/takes.js";
import {trimmed, duration_s} from "../takes/stroke.js";
import {look_at} from "../service/player.js";
import {full, mini, total, shown, left, to_x, to_time, clip_box, most_scroll, scroll_to, show_time, zoom_time, CLIP, LEAST_S} from "./time_axis.js";
import {handles, set_strength, set_speed} from "./curves.js";
import {choose_clip, toggle_append} from "./clips.js";

const REACH = 14;

let held = null;
const touching = new Map(); // pointers on the timeline, by id: x, px
function lane_down(l, e) {
  const r = l.canvas.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top, take = current_take();
  l.canvas.setPointerCapture(e.pointerId);
  touching.set(e.pointerId, x);
  if (touching.size === 2 && !l.mini) { held = {l, kind: "zoom"}; return; }
  held = {l, kind: "look", key: `lane ${performance.now()}`, x};
  if (most_scroll(l) && y > l.top && y < l.bottom && (x < left(l) || x > l.width - 24))
    return void Object.assign(held, {kind: "scroll", y, from: l.scroll, by: x < left(l) ? -1 : most_scroll(l) / (l.bottom - l.top) + 1});
  if (!l.mini && take) {
    const handle = handles(l).find(h => Math.hypot(h.x - x, h.y - y) < REACH);
    if (handle) return void Object.assign(held, handle);
    if (y >= l.ruler - 2 && y <= l.ruler + CLIP) {
      if (x > to_x(l, total()) + 4) { held = null; return toggle_append(); }
      const is_under = s => { const [a, b] = clip_box(l, s); return x >= a - 6 && x <= b + 6; };
      const under = [...take.strokes.keys()].filter(i => is_under(take.strokes[i]));
      if (under.length) {
        const again = under.includes(state.stroke), index = again ? state.stroke : under[0], stroke = take.strokes[index];
        choose_clip(index);
        const [a, b] = clip_box(l, stroke), ends = b - a > 30;
        return void Object.assign(held, {kind: ends && x < a + 10 ? "trim-start" : ends && x > b - 10 ? "trim-end" : "move",
          stroke, index, t: to_time(l, x), next: again ? under[(under.indexOf(index) + 1) % under.length] : index});
      }
    }
  }
  look_at(to_time(l, x));
}
function lane_moved(e) {
  if (!held) return;
  const r = held.l.canvas.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top, t = to_time(held.l, x),
    s = held.stroke;
  if (held.kind === "zoom") return zoom_lanes(held.l, e.pointerId, x);
  if (held.kind === "scroll") return scroll_to(held.l, held.from + (y - held.y) * held.by);
  if (held.kind === "look") return look_at(t);
  if (held.kind === "strength") {
    const v = Math.min(1, Math.max(0, (held.l.height - 8 - y) / (held.l.curves - 20)));
    return set_strength(held.index, v, held.key);
  }
  if (held.kind === "speed") return set_speed(held.index, Math.min(5,
    Math.max(0.1, +((held.l.height - 8 - y) / (held.l.curves - 20) * held.most / held.mean).toFixed(2))), held.key);
  if (Math.abs(x - held.x) < 3 && !held.moved) return;
  held.moved = true;
  if (held.kind === "move") return put_stroke(() => ({...s, start_s: Math.max(0, +(s.start_s + t - held.t).toFixed(3))}), held.key, held.index);
  const d = duration_s(s);
  if (held.kind === "trim-start") put_stroke(() => trimmed(s, Math.min(d - LEAST_S, Math.max(0, t - s.start_s)), d), held.key, held.index);
  else put_stroke(() => trimmed(s, 0, Math.max(LEAST_S, Math.min(d, t - s.start_s))), held.key, held.index);
}
// Keeps the moments under two fingers where the fingers are.
function zoom_lanes(l, id, x) {
  const other = [...touching].find(([k]) => k !== id)[1], before = touching.get(id);
  touching.set(id, x);
  if (Math.abs(x - other) < 20 || Math.abs(before - other) < 20) return;
  const fixed = to_time(l, other), span = shown(l) * Math.abs(before - other) / Math.abs(x - other);
  show_time(fixed - (fixed - l.from) * span / shown(l), span);
}
function lane_up(e) {
  touching.delete(e.pointerId);
  if (held?.kind === "zoom" && touching.size) return;
  // Another tap takes the next of those that lie at the same time.
  if (held?.next !== undefined && !held.moved) choose_clip(held.next);
  if (held) { end_edit(); changed("take"); }
  held = null;
}
for (const l of [full, mini]) {
  l.canvas.addEventListener("pointerdown", e => { if (e.button === 0) lane_down(l, e); });
  l.canvas.addEventListener("pointermove", lane_moved);
  for (const end of ["pointerup", "pointercancel"]) l.canvas.addEventListener(end, lane_up);
  l.canvas.addEventListener("wheel", e => {
    if (l.mini) return;
    e.preventDefault();
    const x = e.clientX - l.canvas.getBoundingClientRect().left;
    if (e.ctrlKey) return zoom_time(Math.exp(e.deltaY / 300), to_time(l, x));
    if (e.deltaX) show_time(full.from + e.deltaX / l.width * shown(l), shown(l));
    scroll_to(l, l.scroll + e.deltaY);
  }, {passive: false});
  l.canvas.addEventListener("keydown", e => {
    const step = {ArrowLeft: -1, ArrowRight: 1}[e.key], rows = {ArrowUp: -1, ArrowDown: 1}[e.key];
    if (rows) { e.preventDefault(); return scroll_to(l, l.scroll + rows * 36); }
    if (!step && e.key !== "Home" && e.key !== "End") return;
    e.preventDefault();
    look_at(e.key === "Home" ? 0 : e.key === "End" ? total() : state.at_s + step * total() / (e.shiftKey ? 500 : 50));
  });
}
