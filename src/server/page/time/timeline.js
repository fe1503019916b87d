// SPDX-License-Identifier: MIT
// Pointers and keys on the timelines: choose a moment, move and trim clips, drag points of speed and strength.
import {listen} from "../../../net/page/dom.js";
import {state, changed, current_take, marks, say, now_ms} from "../state.js";
import {put_stroke, edit_take, end_edit} from "../takes/takes.js";
import {trimmed, duration_s, end_s} from "../takes/stroke.js";
import {clamp} from "../geometry.js";
import {look_at} from "../service/player.js";
import {PAUSE_S, begin_live, send} from "../drawing/pointer.js";
import {full, mini, total, shown, left, to_x, to_time, clip_box, most_scroll, scroll_to, show_time, zoom_time, CLIP, LEAST_S} from "./time_axis.js";
import {set_marks, set_range, clear_marks, snapped} from "./time_axis.js";
import {handles, set_strength, set_speed, touch_curve} from "./curves.js";
import {choose_clip, toggle_append, copy_clip, with_copies, starting_at} from "./clips.js";
import {tell} from "../service/connection.js";

const REACH = 14;
const REPEAT_PX = 24, DOUBLE_MS = 350; // distance for each copy; interval of a double tap

let held = null, tapped_ms = 0;
const touching = new Map(); // pointers on the timeline, by id: x, px
function lane_down(l, e) {
  const r = l.canvas.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top, take = current_take();
  l.canvas.setPointerCapture(e.pointerId);
  touching.set(e.pointerId, x);
  l.held_s = shown(l);
  if (touching.size === 2 && !l.mini) { held = {l, kind: "zoom"}; return; }
  held = {l, kind: "look", key: now_ms(), x, y, off_s: 0};
  if (most_scroll(l) && y > l.top && y < l.bottom && (x < left(l) || x > l.width - 24))
    return void Object.assign(held, {kind: "scroll", from: l.scroll, by: x < left(l) ? -1 : most_scroll(l) / (l.bottom - l.top) + 1});
  if (!l.mini && take) {
    if (y < l.ruler - 2) return void Object.assign(held, hold_ruler(l, x, e));
    touch_curve_at(l, x, y);
    const handle = handles(l).find(h => Math.hypot(h.x - x, h.y - y) < REACH);
    if (handle) return void Object.assign(held, handle, {x, y, rise: (y - handle.y) / (l.curves - 20)});
    if (y >= l.ruler - 2 && y <= l.ruler + CLIP) {
      if (x > to_x(l, total()) + 4) { held = null; return toggle_append(); }
      const under = [...take.strokes.keys()].filter(i => { const [a, b] = clip_box(l, take.strokes[i]); return x >= a - 6 && x <= b + 6; });
      if (under.length) {
        const again = under.includes(state.stroke), index = again ? state.stroke : under[0], stroke = take.strokes[index];
        choose_clip(index);
        const [a, b] = clip_box(l, stroke), ends = b - a > 30, kind = ends && x < a + 10 ? "trim-start" : ends && x > b - 10 ? "trim-end" : "move";
        return void Object.assign(held, {kind, off_s: (kind === "trim-end" ? end_s(stroke) : stroke.start_s) - to_time(l, x),
          stroke, index, take, alt: e.altKey, next: again ? under[(under.indexOf(index) + 1) % under.length] : index});
      }
    }
  }
  look_at(to_time(l, x));
}
// Touches the curve whose point is nearest, if a pointer is among the curves.
function touch_curve_at(l, x, y) {
  const far = h => Math.hypot(h.x - x, h.y - y), nearest = l.curves && y > l.height - l.curves && handles(l).reduce((a, b) => a && far(a) <= far(b) ? a : b, null);
  touch_curve(nearest ? nearest.kind : "");
}
// Grasps a thing on the ruler: an end of the range, the mark of the time shown, or a place where a range begins.
function hold_ruler(l, x, e) {
  const is_near = (t, px) => Math.abs(to_x(l, t) - x) < px, {range} = marks();
  const end = range?.findIndex(t => is_near(t, e.pointerType === "touch" ? 22 : 8)) ?? -1;
  return {ruler: true, ...!(end < 0 && is_near(state.at_s, 8)) && {kind: "range", fixed: range?.[1 - end] ?? snapped(l, to_time(l, x), e),
    off_s: end < 0 ? 0 : range[end] - to_time(l, x)}};
}
function tap_ruler(t, now = now_ms()) {
  if (now - tapped_ms < DOUBLE_MS) return clear_marks();
  tapped_ms = now;
  set_marks({start_s: t});
  look_at(t);
}
// Trims a clip at its end, or repeats it if the end is pulled farther.
function pull_end({take, stroke, index, key}, px, t) {
  const end = t < end_s(stroke) ? trimmed(stroke, 0, Math.max(LEAST_S, t - stroke.start_s)) : stroke;
  const strokes = with_copies({...take, strokes: take.strokes.map((s, i) => i === index ? end : s)}, index, px / REPEAT_PX, end_s(stroke) + PAUSE_S);
  edit_take(() => ({strokes}), key);
  if (strokes[take.strokes.length]) say(`“${strokes[index].name}” × ${strokes.length - take.strokes.length + 1}`);
}
function lane_moved(e) {
  if (!held) {
    const r = full.canvas.getBoundingClientRect();
    return e.target === full.canvas ? touch_curve_at(full, e.clientX - r.left, e.clientY - r.top) : undefined;
  }
  const r = held.l.canvas.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top, t = to_time(held.l, x), s = held.stroke;
  const high = (held.l.height - 8 - y) / (held.l.curves - 20) + held.rise;
  if (held.kind === "zoom") return zoom_lanes(held.l, e.pointerId, x);
  if (held.kind === "scroll") return scroll_to(held.l, held.from + (y - held.y) * held.by);
  // A handle that is only chosen does not move; a dragged one keeps its distance from the pointer.
  if (Math.abs(held.rise === undefined ? x - held.x : y - held.y) < 3 && !held.moved) return;
  const copies = held.alt && !held.moved && held.kind === "move", near = snapped(held.l, t + held.off_s, e, held.index, held.kind !== "move");
  held.moved = true;
  if (held.kind === "strength") return set_strength(held.index, clamp(high, 0, 1), held.key);
  if (held.kind === "speed") return set_speed(held.index, clamp(+(high * held.most / held.mean).toFixed(2), 0.1, 5), held.key);
  if (held.kind === "look") return scrub_to(near, held.key);
  if (held.kind === "range") return set_range(held.fixed, clamp(near, 0, total()));
  if (held.kind === "trim-end") return pull_end(held, x - held.x, near);
  if (copies) held.index = copy_clip(s.start_s, held.key);
  put_stroke(held.kind === "trim-start" ? () => trimmed(s, clamp(near - s.start_s, 0, duration_s(s) - LEAST_S), duration_s(s))
    : k => starting_at(k, near), held.key, held.index);
}
// Zooms so that the moments under two fingers stay under them.
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
  // Another tap chooses the next clip at the same time.
  if (held?.next !== undefined && !held.moved) choose_clip(held.next);
  if (held?.ruler && !held.moved) tap_ruler(snapped(held.l, to_time(held.l, held.x), e));
  else if (held) { end_edit(); changed("take"); }
  end_scrub();
  full.held_s = mini.held_s = held = null;
}

// Scrubbing: a live stroke plays the burst at the dragged moment.
const FELT_STEP_MS = 50, FELT_REST_MS = 500; // interval of bursts; time until a resting moment falls silent
let live = null, moved_ms = 0, feeler;

const has_stopped = since_ms => state.playing || state.stopping || state.stopped?.at > since_ms;
// Moves to a moment. It is felt unless a stop came after the drag began.
function scrub_to(s, began_ms) {
  const before = state.at_s;
  look_at(s);
  if (!state.scrub || state.at_s === before || state.link !== "connected" || has_stopped(began_ms)) return;
  moved_ms = now_ms();
  feeler ||= setInterval(feel_moment, FELT_STEP_MS);
}
function end_scrub() {
  feeler = clearInterval(feeler);
  if (live) live.track.down = false; // a stroke without a number yet ends when it gets one
  if (live?.number) tell("end", {stroke: live.number});
  live = null;
}
function feel_moment() {
  const now = now_ms(), plan = state.plan, t = state.at_s + 1e-4;
  const row = plan?.onsets.map((onset, i) => onset <= t && t < onset + plan.durations[i]).lastIndexOf(true) ?? -1;
  if (row < 0 || now - moved_ms > FELT_REST_MS || has_stopped(moved_ms)) return end_scrub();
  const is_new = !live;
  live ??= {number: null, sent_ms: 0, track: {down: true}};
  Object.assign(live, {at: plan.positions.slice(2 * row, 2 * row + 2), strength: plan.intensities[row]});
  if (is_new) begin_live(live); else send(live, now);
}

for (const l of [full, mini]) {
  listen(l.canvas, "pointerdown", e => { if (e.button === 0) lane_down(l, e); });
  listen(l.canvas, "pointermove", lane_moved);
  for (const end of ["pointerup", "pointercancel"]) listen(l.canvas, end, lane_up);
  listen(l.canvas, "pointerleave", () => { if (!held) touch_curve(""); });
  listen(l.canvas, "wheel", e => {
    if (l.mini) return;
    e.preventDefault();
    const x = e.clientX - l.canvas.getBoundingClientRect().left;
    if (e.ctrlKey) return zoom_time(Math.exp(e.deltaY / 300), to_time(l, x));
    const along = e.deltaX || (e.shiftKey || !most_scroll(l) ? e.deltaY : 0); // if all lanes show, there is nothing to scroll
    if (along) show_time(full.from + along / l.width * shown(l), shown(l)); else scroll_to(l, l.scroll + e.deltaY);
  }, {passive: false});
  listen(l.canvas, "keydown", e => {
    const step = {ArrowLeft: -1, ArrowRight: 1}[e.key], rows = {ArrowUp: -1, ArrowDown: 1}[e.key];
    if (rows) { e.preventDefault(); return scroll_to(l, l.scroll + rows * 36); }
    if (!step && !["Home", "End", "Enter"].includes(e.key)) return;
    e.preventDefault();
    if (e.key === "Enter") return e.shiftKey ? set_range(marks().start_s, state.at_s) : set_marks({start_s: state.at_s});
    scrub_to(e.key === "Home" ? 0 : e.key === "End" ? total() : state.at_s + step * total() / (e.shiftKey ? 500 : 50), now_ms());
  });
}
