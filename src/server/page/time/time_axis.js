// SPDX-License-Identifier: MIT
// The two timelines: seconds to pixels, tactors to lanes, the visible part of both, and marks on them.
import {state, changed, on_change, current_take, marks} from "../state.js";
import {colour, write, paint, plot} from "../look.js";
import {by_id, make} from "../../../net/page/dom.js";
import {take_s} from "../takes/takes.js";
import {end_s, kept_for} from "../takes/stroke.js";
import {array} from "../drawing/view.js";
import {clamp} from "../geometry.js";
import {seconds_text} from "../words.js";

export const CLIP = 26;
const RULER = 30, TOUCHED_RULER = 44, CURVES = 58;
const STRIP_PX = 100, ROOM_FOR_CURVES_PX = 230; // heights of the timeline
const LEAST_LANE_PX = 18, MOST_LANE_PX = 30;
const MANY_TACTORS = 16;   // with more, only tactors that play have a lane
export const LEAST_AMPLITUDE = 0.004;
export const LEAST_S = 0.06;
export const MOST_S = 599.9; // with its last burst a stroke has at most 600 s
const LABEL = 64, RIGHT = 58, EDGE = 14;
const SNAP_PX = 5;

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
// Returns the total length of the shown time.
export const total = () => Math.max(state.plan?.total_s ?? 0, state.drawing ? 0 : take_s(current_take()));
const whole = () => Math.max(total(), LEAST_S) * 1.02;
// Returns the visible time span. While a pointer is down (held_s) the axis stays the same, even if a drag changes the length.
export const shown = l => l.span ?? l.held_s ?? whole();
export const left = l => l.thin ? EDGE : LABEL;
export const right = l => l.mini ? EDGE : RIGHT;
export const to_x = (l, t) => left(l) + (t - l.from) / shown(l) * (l.width - left(l) - right(l));
export const to_time = (l, x) => l.from + (x - left(l)) / (l.width - left(l) - right(l)) * shown(l);
export const clip_box = (l, s) => [to_x(l, s.start_s), to_x(l, end_s(s))];

// Returns the tactors with a lane: if there are many, those that play, in the order in which they begin.
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
  return l.thin ? h : clamp(h, LEAST_LANE_PX, MOST_LANE_PX);
}
// Returns the greatest scroll offset of the lanes, px.
export const most_scroll = l => Math.max(0, lane_count() * lane_height(l) - (l.bottom - l.top));
export function scroll_to(l, px) {
  l.scroll = clamp(px, 0, most_scroll(l));
  l.stale = true;
  changed("frame");
}

// Shows the whole time.
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

// Changes marks: the start and the range of Play.
export function set_marks(change) { state.marks = {...marks(), ...change, take: state.current}; changed("curves"); }
export const clear_marks = () => set_marks({start_s: 0, range: null});
export function set_range(a, b) { if (Math.abs(b - a) >= LEAST_S) set_marks({range: [a, b].sort((p, q) => p - q)}); }

// Returns a moment, snapped to the start, to a burst, or to an end of another stroke if it is near.
export const snapped = (l, t, e, moved, to_bursts = true) => e.altKey ? t : [marks().start_s,
  ...current_take()?.strokes.flatMap((s, i) => i === moved ? [] : [s.start_s, end_s(s)]) ?? [],
  ...to_bursts && state.plan?.onsets || []].find(v => Math.abs(to_x(l, v) - to_x(l, t)) <= SNAP_PX) ?? t;

export function draw_time_marks(p, l) {
  const {start_s, range} = marks(), bottom = l.height - 8, x = to_x(l, start_s);
  if (range) {
    const [a, b] = range.map(t => Math.max(left(l), to_x(l, t)));
    p.fillStyle = colour("ink"); p.globalAlpha = 0.07; p.fillRect(a, 0, b - a, bottom); p.globalAlpha = 1;
    p.fillRect(a - 3, 1, 3, l.ruler - 5); p.fillRect(b, 1, 3, l.ruler - 5); p.fillRect(a, 1, b - a, l.thin ? 3 : 14);
    const text = `${state.loop && b - a > 80 ? "loop " : ""}${seconds_text(range[1] - range[0])}`;
    if (b - a > 40 && !l.thin) write(p, text, (a + b) / 2, 12, "panel", {size: 11, weight: 600});
  }
  if (!start_s || x < left(l)) return;
  p.setLineDash([2, 3]);
  plot(p, [x, 14], [x, bottom]); paint(p, {line: "ink2", width: 1.5});
  p.setLineDash([]);
  plot(p, [x, 13], [x + 9, 18], [x, 24]); paint(p, {fill: "ink2"});
}
