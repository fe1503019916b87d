// SPDX-License-Identifier: MIT
// The two timelines: seconds to pixels, tactors to lanes, and what part of both is shown.
import {state, changed, on_change, current_take} from "../state.js";
import {by_id, make} from "../../../net/page/dom.js";
import {take_s} from "../takes/takes.js";
import {end_s, kept_for} from "../takes/stroke.js";
import {array} from "../drawing/view.js";

export const CLIP = 26;
const RULER = 30, TOUCHED_RULER = 44, CURVES = 58;
const STRIP_PX = 100, ROOM_FOR_CURVES_PX = 230; // heights of the timeline
const LEAST_LANE_PX = 18, MOST_LANE_PX = 30;
const MANY_TACTORS = 16;   // above this only those that play have a lane
export const LEAST_AMPLITUDE = 0.004;
export const LEAST_S = 0.06;
export const MOST_S = 599.9; // with its last burst a stroke has at most 600 s
const LABEL = 64, RIGHT = 58, EDGE = 14;

function make_lanes(canvas, mini) {
  const own = {canvas, mini, moment: make("i", {class: "moment"}), width: 0, height: 0, stale: true, from: 0, span: null, scroll: 0};
  canvas.after(own.moment);
  new ResizeObserver(() => { measure(own); changed("frame"); }).observe(canvas.parentElement);
  return own;
}
export const full = make_lanes(by_id("lanes"), false);
export const mini = make_lanes(by_id("mini"), true);

function measure(l) {
  const r = l.canvas.getBoundingClientRect(), dpr = Math.min(3, devicePixelRatio || 1);
  // A strip has a thin line for each tactor, and no ruler.
  const thin = l.mini || r.height < STRIP_PX;
  Object.assign(l, {width: r.width, height: r.height, dpr, stale: true, thin,
    ruler: thin ? 4 : matchMedia("(pointer: coarse)").matches ? TOUCHED_RULER : RULER,
    curves: !thin && r.height >= ROOM_FOR_CURVES_PX ? CURVES : 0});
  l.top = l.mini ? 8 : l.ruler + CLIP + (thin ? 0 : 8);
  l.bottom = l.height - l.curves - (thin ? 6 : 2);
  l.canvas.width = Math.round(r.width * dpr); l.canvas.height = Math.round(r.height * dpr);
  l.moment.classList.toggle("thin", thin);
}
// Part of a take that is shown, or all of it.
export const total = () => Math.max(state.plan?.total_s ?? 0, state.drawing ? 0 : take_s(current_take()));
const whole = () => Math.max(total(), LEAST_S) * 1.02;
export const shown = l => l.span ?? whole();
export const left = l => l.thin ? EDGE : LABEL;
export const right = l => l.mini ? EDGE : RIGHT;
export const to_x = (l, t) => left(l) + (t - l.from) / shown(l) * (l.width - left(l) - right(l));
export const to_time = (l, x) => l.from + (x - left(l)) / (l.width - left(l) - right(l)) * shown(l);
export const clip_box = (l, s) => [to_x(l, s.start_s), to_x(l, end_s(s))];

// Lanes: the tactors in the order in which they begin where there are many, else all.
const in_order = kept_for(plan => {
  const first = new Map(), n = plan.tactors;
  plan.onsets.forEach((t, i) => { for (let k = 0; k < n; ++k) if (plan.amplitudes[i * n + k] >= LEAST_AMPLITUDE
    && !(first.get(k) <= t)) first.set(k, t); });
  return [...first.keys()].sort((a, b) => first.get(a) - first.get(b) || a - b);
});
export const lane_tactors = () => state.plan?.onsets && array.places.length > MANY_TACTORS ? in_order(state.plan)
  : [...array.places.keys()];
export const silent_count = () => array.places.length - lane_tactors().length;
const lane_count = () => Math.max(1, lane_tactors().length + (silent_count() ? 1 : 0));
export function lane_height(l) {
  const h = (l.bottom - l.top) / lane_count();
  return l.thin ? h : Math.min(MOST_LANE_PX, Math.max(LEAST_LANE_PX, h));
}
// Returns how far the lanes can be scrolled, px.
export const most_scroll = l => Math.max(0, lane_count() * lane_height(l) - (l.bottom - l.top));
export function scroll_to(l, px) {
  l.scroll = Math.min(most_scroll(l), Math.max(0, px));
  l.stale = true;
  changed("frame");
}

// The part of the time that is shown.
export function show_all_time() { Object.assign(full, {from: 0, span: null, stale: true}); changed("frame"); }
export function show_time(from, span) {
  full.span = span >= whole() ? null : Math.max(0.1, span);
  full.from = Math.max(0, Math.min(whole() - shown(full), from));
  full.stale = true;
  changed("frame");
}
export function zoom_time(by, at_s = state.at_s) {
  const span = Math.min(whole(), Math.max(0.1, shown(full) * by));
  show_time(at_s - (at_s - full.from) * span / shown(full), span);
}

let shown_take = null;
on_change(() => { full.stale = mini.stale = true; }, "take", "plan", "hot", "theme", "array", "curves", "drawing", "level");
on_change(() => { measure(full); measure(mini); }, "layout");
on_change(() => {
  if (state.current !== shown_take) Object.assign(full, {from: 0, span: null, scroll: 0});
  shown_take = state.current;
}, "take");

