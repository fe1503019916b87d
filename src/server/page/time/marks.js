// SPDX-License-Identifier: MIT
// Marks of the time axis: where Play starts and the range that it plays; and the moments to which pointers snap.
import {state, changed, current_take, marks} from "../state.js";
import {colour} from "../look.js";
import {write, paint, plot} from "../drawing/pen.js";
import {end_s} from "../takes/stroke.js";
import {seconds_text} from "../words.js";
import {left, to_x, LEAST_S} from "./time_axis.js";

const SNAP_PX = 5;

export function set_marks(change) { state.marks = {...marks(), ...change, take: state.current}; changed("curves"); }
export const clear_marks = () => set_marks({start_s: 0, range: null});
export function set_range(a, b) { if (Math.abs(b - a) >= LEAST_S) set_marks({range: [a, b].sort((p, q) => p - q)}); }

// Returns a moment, or what it is so near to that it snaps: the start, an end of a stroke but the one that is moved, a burst.
export const snapped = (l, t, e, moved) => e.altKey || !state.snap ? t : [marks().start_s,
  ...current_take()?.strokes.flatMap((s, i) => i === moved ? [] : [s.start_s, end_s(s)]) ?? [],
  ...moved >= 0 ? [] : state.plan?.onsets ?? []].find(v => Math.abs(to_x(l, v) - to_x(l, t)) <= SNAP_PX) ?? t;

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
