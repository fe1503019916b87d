// Moves felt points: diamonds where points of the stroke are felt, at most one each 10 mm. The point moves until it is felt at the diamond, or as
// near as possible.
import {state, changed, on_change, current_take, current_stroke, say, now_ms} from "../state.js";
import {plot, paint, disc} from "../look.js";
import {array, trace_rows, to_px, view} from "./view.js";
import {edit_stroke} from "../takes/takes.js";
import {editable, changed_knot, nearest_knot, handles_apart, knot_times, interpolate} from "../takes/stroke.js";
import {within} from "../geometry.js";
import {number_text} from "../words.js";

const GRASP_PX = 22, WISH_STEPS = 24, LEAST_PART = 0.2;
const HERE_MM = 0.25, SOLVED_MM = 0.05;
const APART_MM = 10, APART_PITCHES = 0.5; // diamonds along the path; less if the array's pitch is small

let wish = null; // {knot, at, steps, part, best, before, after, key}; `steps`: remaining steps

// Returns the diamonds: numbers of points, and their felt places. The ends and the chosen point have one.
export function felt_points(s = current_stroke()) {
  const i = state.stroke, rows = s && state.plan?.felt_rows[i];
  if (!rows?.length) return [];
  const {knots} = editable(s), times = knot_times(editable(s)), apart = Math.min(APART_MM, APART_PITCHES * array.pitch);
  return handles_apart(knots, apart, state.knot).map(knot => {
    const [, x, y] = interpolate(rows, state.plan.strokes[i].start_s + times[knot]);
    return {knot, x, y};
  });
}
function start_wish(knot) {
  wish = {knot, before: current_stroke().timed, key: `felt ${now_ms()}`};
  state.knot = knot;
  changed("knot");
}
// Grasps the diamond near a place, if there is one; returns its distance.
export function grasp_felt(mm) {
  const points = felt_points(), near = nearest_knot(points, mm), at = points[near.index];
  if (near.off * view.scale > GRASP_PX) return null;
  start_wish(at.knot);
  return [at.x - mm[0], at.y - mm[1]];
}
// Sets the place at which the grasped point is to be felt.
export function pull(at) {
  Object.assign(wish, {at, steps: WISH_STEPS, part: 1, best: null});
  changed("knot");
  solve();
}
export function step_felt(knot, [dx, dy]) {
  const felt = felt_points().find(q => q.knot === knot);
  if (!felt) return;
  start_wish(knot);
  pull([felt.x + dx, felt.y + dy]);
}
// Adds the error, or a part of it, to the point, from the best position so far. If that does not help, because the felt place jumps between
// triangles, tries positions round about. Each plan calls this again.
function solve() {
  if (!(wish?.steps >= 0) || wish.knot !== state.knot || state.plan_of !== current_take()) return;
  const s = current_stroke();
  if (wish.after && wish.after !== s) { wish.steps = -1; return; } // undone, or changed by another hand
  const felt = felt_points().find(q => q.knot === wish.knot), k = editable(s).knots[wish.knot];
  const error = [wish.at[0] - felt.x, wish.at[1] - felt.y], off = Math.hypot(...error);
  if (off >= wish.best?.off) wish.part /= 2; else Object.assign(wish, {best: {off, at: [k.x, k.y], error}, part: 1});
  const {best, part, steps} = wish, solved = !steps || best.off < SOLVED_MM, far = best.off * steps / WISH_STEPS;
  const by = solved ? [0, 0] : part > LEAST_PART ? best.error.map(v => v * part) : [far * Math.cos(2.4 * steps), far * Math.sin(2.4 * steps)];
  const [x, y] = within(array.edge, best.at.map((v, i) => v + by[i])).map(v => +v.toFixed(3));
  wish.steps = solved ? -1 : steps - 1;
  if (solved) say(best.off < HERE_MM ? `Felt here, within ${number_text(Math.max(0.1, best.off))} mm` : `Cannot be felt there: ${number_text(best.off)} mm away at best`);
  if (x !== k.x || y !== k.y) edit_stroke(q => changed_knot({...q, ink: q.ink ?? q.timed}, wish.knot, {x, y}), wish.key);
  else if (!solved) solve();
  wish.after = current_stroke();
}
on_change(() => { wish = null; }, "tool");
on_change(solve, "plan");

// Draws the diamonds, and for a grasped point its target as a ring, the remaining distance, and the former path.
export function draw_felt_points(p, s) {
  const points = felt_points(s), places = points.map(q => to_px([q.x, q.y])), held = points.findIndex(q => q.knot === wish?.knot);
  if (wish?.at && wish.after === s && held >= 0) {
    const at = to_px(wish.at), thin = {line: "felt", width: 1.5};
    p.setLineDash([4, 4]);
    trace_rows(p, wish.before); paint(p, thin);
    disc(p, at, 13); paint(p, thin);
    p.setLineDash([]);
    plot(p, at, places[held]); paint(p, thin);
  }
  places.forEach(([x, y], i) => {
    plot(p, [x, y - 9], [x + 9, y], [x, y + 9], [x - 9, y], [x, y - 9]);
    paint(p, {fill: points[i].knot === state.knot ? "felt" : "raised", line: "felt", width: 2});
  });
}
