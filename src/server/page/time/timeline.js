// SPDX-License-Identifier: MIT
// Pointers and keys on the timelines: look at a moment, move and trim clips, drag points of speed and strength.
import {state, changed, current_take, say} from "../state.js";
import {put_stroke, end_edit} from "../takes/takes.js";
import {trimmed, duration_s} from "../takes/stroke.js";
import {look_at} from "../service/player.js";
import {full, mini, total, to_x, to_time, RULER, CLIP, CURVES, LEAST_S} from "./time_axis.js";
import {handles, set_strength, set_speed} from "./curves.js";
import {clip_box, zoom_time} from "./lanes.js";

const REACH = 14;

let held = null;
function choose_clip(i) {
  if (i !== state.stroke) Object.assign(state, {stroke: i, knot: -1});
  changed("take");
}
function lane_down(l, e) {
  const r = l.canvas.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top, take = current_take();
  l.canvas.setPointerCapture(e.pointerId);
  held = {l, kind: "look", key: `lane ${performance.now()}`, x};
  if (!l.mini && take) {
    const handle = handles(l).find(h => Math.hypot(h.x - x, h.y - y) < REACH);
    if (handle) return void Object.assign(held, handle);
    if (y >= RULER - 2 && y <= RULER + CLIP) {
      if (x > to_x(l, total()) + 4) { held = null; state.append = !state.append;
        say(state.append ? "Draw: it follows the last stroke" : "Drawings are takes of their own"); return changed("curves"); }
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
  if (held.kind === "look") return look_at(t);
  if (held.kind === "strength") {
    const v = Math.min(1, Math.max(0, (held.l.height - 8 - y) / (CURVES - 20)));
    return set_strength(held.index, v, held.key);
  }
  if (held.kind === "speed") return set_speed(held.index, Math.min(5,
    Math.max(0.1, +((held.l.height - 8 - y) / (CURVES - 20) * held.most / held.mean).toFixed(2))), held.key);
  if (Math.abs(x - held.x) < 3 && !held.moved) return;
  held.moved = true;
  if (held.kind === "move") return put_stroke(() => ({...s, start_s: Math.max(0, +(s.start_s + t - held.t).toFixed(3))}), held.key, held.index);
  const d = duration_s(s);
  if (held.kind === "trim-start") put_stroke(() => trimmed(s, Math.min(d - LEAST_S, Math.max(0, t - s.start_s)), d), held.key, held.index);
  else put_stroke(() => trimmed(s, 0, Math.max(LEAST_S, Math.min(d, t - s.start_s))), held.key, held.index);
}
function lane_up() {
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
    if (Math.abs(e.deltaX) > Math.abs(e.deltaY) && full.span) { full.from = Math.max(0,
      Math.min(total() * 1.02 - full.span, full.from + e.deltaX / l.width * full.span)); full.stale = true; changed("frame"); }
    else zoom_time(Math.exp(e.deltaY / 300), to_time(l, x));
  }, {passive: false});
  l.canvas.addEventListener("keydown", e => {
    const step = {ArrowLeft: -1, ArrowRight: 1}[e.key];
    if (!step && e.key !== "Home" && e.key !== "End") return;
    e.preventDefault();
    look_at(e.key === "Home" ? 0 : e.key === "End" ? total() : state.at_s + step * total() / (e.shiftKey ? 500 : 50));
  });
}
