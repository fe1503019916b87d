// SPDX-License-Identifier: MIT
// The two timelines: seconds to pixels, and what part of the time is shown.
import {state, changed, on_change, current_take} from "../state.js";
import {by_id} from "../../../net/page/dom.js";
import {take_s} from "../takes/takes.js";

export const RULER = 30;
export const CLIP = 26;
export const CURVES = 76;
export const LEAST_S = 0.06;
export const MOST_S = 599.9; // with its last burst a stroke has at most 600 s
const LABEL = 58, RIGHT = 58, EDGE = 14;

function make_lanes(canvas, mini) {
  const own = {canvas, mini, layer: document.createElement("canvas"), width: 0, height: 0, stale: true, from: 0, span: null};
  new ResizeObserver(() => { measure(own); changed("frame"); }).observe(canvas.parentElement);
  return own;
}
export const full = make_lanes(by_id("lanes"), false);
export const mini = make_lanes(by_id("mini"), true);

function measure(l) {
  const r = l.canvas.getBoundingClientRect(), dpr = Math.min(3, devicePixelRatio || 1);
  Object.assign(l, {width: r.width, height: r.height, dpr, stale: true});
  for (const c of [l.canvas, l.layer]) { c.width = Math.round(r.width * dpr); c.height = Math.round(r.height * dpr); }
}
// Part of a take that is shown, or all of it.
export const total = () => Math.max(state.plan?.total_s ?? 0, state.drawing ? 0 : take_s(current_take()), 0.06);
export const shown = l => l.span ?? total() * 1.02;
export const left = l => l.mini ? EDGE : LABEL;
export const right = l => l.mini ? EDGE : RIGHT;
export const to_x = (l, t) => left(l) + (t - l.from) / shown(l) * (l.width - left(l) - right(l));
export const to_time = (l, x) => l.from + (x - left(l)) / (l.width - left(l) - right(l)) * shown(l);

let shown_take = null;
on_change(what => {
  if (["take", "plan", "hot", "theme", "array", "layout", "curves", "drawing",
    "level"].some(w => what.has(w))) full.stale = mini.stale = true;
  if (state.current !== shown_take) Object.assign(full, {from: 0, span: null});
  shown_take = state.current;
  if (what.has("layout")) { measure(full); measure(mini); }
});

