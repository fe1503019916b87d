// SPDX-License-Identifier: MIT
// Strokes as values. A stroke is {name, start_s, timed} and, once it can be edited, {base, knots, pace, strength}:
// timed is [[t_s, x_mm, y_mm, intensity], ...] and what is played; base is `timed` as it was before all edits;
// knots [{x, y, corner, at, curve, moved}] lie on its path, `at` seconds of the base; with `curve` the path from a knot
// to the next one is a spline, otherwise it is the base; pace says when which part of the path is reached; strength is
// [[part, factor], ...]. A drawing has {ink} too, [[t_s, x_mm, y_mm, pressure], ...], which never changes, and
// {edited} while it plays as drawn: what it was before.

import {blend, box, clamp, distance, sampled, segment_mm} from "../geometry.js";

const SMOOTH_S = 0.012;
export const FIT_MM = 0.2; // greatest distance of curve and base from each other
const LOOK_MM = 0.25;      // distance of the places where they are compared
const LONGEST_MM = 40;     // greatest distance of two knots
const STEP_MM = 0.5;
const STEP_S = 0.02;
const MOST_POINTS = 20000;
const TIMED_WEIGHTS = [1, 1, 4]; // weights of x, y and intensity
const CORNER_RAD = 50 * Math.PI / 180; // within 1 mm

export const duration_s = s => s.timed.at(-1)[0];
export const end_s = s => s.start_s + duration_s(s);
export const total_s = strokes => strokes.reduce((most, s) => Math.max(most, end_s(s)), 0);

// Finds the index of the last row whose first value is at most v, by halving.
function row_before(rows, v) {
  let low = 0, high = rows.length - 1;
  while (low < high) {
    const mid = (low + high + 1) >> 1;
    if (rows[mid][0] <= v) low = mid; else high = mid - 1;
  }
  return low;
}

// Returns a row of a table between two of its rows; beyond its ends, the first or the last row.
export function interpolate(rows, v) {
  if (v <= rows[0][0]) return rows[0];
  if (v >= rows.at(-1)[0]) return rows.at(-1);
  const i = row_before(rows, v), a = rows[i], b = rows[i + 1], part = (v - a[0]) / (b[0] - a[0] || 1);
  return a.map((x, k) => blend(x, b[k], part));
}

// Makes a function of immutable values that caches its result for as long as the value exists.
export function kept_for(f) {
  const kept = new WeakMap();
  return value => { if (!kept.has(value)) kept.set(value, f(value)); return kept.get(value); };
}
// Returns the length of path up to each point, mm.
const lengths_mm = kept_for(timed => {
  let sum = 0;
  return timed.map((p, i) => i ? sum += distance(p.slice(1), timed[i - 1].slice(1)) : 0);
});
export const length_mm = timed => lengths_mm(timed).at(-1);
// Returns the parts of path and time at each point. On a path without length, both parts are equal.
export const parts_reached = kept_for(timed => {
  const total = length_mm(timed), seconds = timed.at(-1)[0];
  return timed.map((p, i) => [total > 0 ? lengths_mm(timed)[i] / total : p[0] / seconds, p[0] / seconds]);
});

// Returns [[length so far, x, y, ...], ...] of [[x, y, ...], ...], without repeated points.
function along(places) {
  const rows = [];
  let sum = 0;
  for (const place of places) {
    if (rows.length) {
      const d = distance(place, rows.at(-1).slice(1));
      if (d < 1e-6) continue;
      sum += d;
    }
    rows.push([sum, ...place]);
  }
  return rows;
}

// Returns the spline (Catmull-Rom, centripetal) from knot i to the next one as places STEP_MM apart, with both ends.
function spline_piece(knots, i) {
  const b = knots[i], c = knots[i + 1], out = [];
  const ends = c.corner || i + 2 === knots.length, begins = b.corner || i === 0;
  const a = !begins ? knots[i - 1] : ends ? mirrored(b, c) : bent(b, c, knots[i + 2]);
  const d = !ends ? knots[i + 2] : begins ? mirrored(c, b) : bent(c, b, knots[i - 1]);
  const steps = Math.max(1, Math.ceil(Math.hypot(c.x - b.x, c.y - b.y) / STEP_MM));
  for (let k = 0; k < steps; ++k) out.push(catmull_rom(a, b, c, d, k / steps));
  return [...out, [c.x, c.y]];
}
// Returns the rows of the base from knot i to the next one.
function base_piece({base, knots}, i) {
  const from = knots[i].at, to = knots[i + 1].at;
  return [interpolate(base, from), ...base.slice(row_before(base, from) + 1, row_before(base, to) + 1).filter(p => p[0] < to),
    interpolate(base, to)];
}
// Returns the path from knot i to the next one: rows like those of the base, in its time.
function path_piece(s, i) {
  const rows = base_piece(s, i);
  if (!s.knots[i].curve) return rows;
  const line = along(spline_piece(s.knots, i)), long = line.at(-1)[0], from = rows[0][0], span = rows.at(-1)[0] - from;
  const reached = lengths_mm(rows), total = reached.at(-1);
  const by_time = rows.map(([t], k) => [t, total > 0 ? reached[k] / total : (t - from) / span]);
  const n = Math.max(1, Math.ceil(long / STEP_MM), Math.ceil(span / STEP_S));
  const times = [...rows.map(r => r[0]), ...sampled(n, part => from + span * part).slice(1, -1)];
  return times.sort((a, b) => a - b).map(t => [t, ...interpolate(line, long * interpolate(by_time, t)[1]).slice(1),
    interpolate(rows, t)[3]]);
}
const path_pieces = s => s.knots.slice(1).map((_, i) => path_piece(s, i));

// Returns a place beyond an end that continues the bend of the three knots there.
const bent = (at, next, then) => ({x: 3 * (at.x - next.x) + then.x, y: 3 * (at.y - next.y) + then.y});
const mirrored = (at, from) => ({x: 2 * at.x - from.x, y: 2 * at.y - from.y});
function catmull_rom(a, b, c, d, part) {
  const gap = (p, q) => Math.max(1e-4, Math.sqrt(Math.hypot(p.x - q.x, p.y - q.y)));
  const t1 = gap(a, b), t2 = t1 + gap(b, c), t3 = t2 + gap(c, d), t = blend(t1, t2, part);
  return ["x", "y"].map(k => {
    const mix = (p, q, from, to) => ((to - t) * p + (t - from) * q) / (to - from);
    const ab = mix(a[k], b[k], 0, t1), bc = mix(b[k], c[k], t1, t2), cd = mix(c[k], d[k], t2, t3);
    return mix(mix(ab, bc, 0, t2), mix(bc, cd, t1, t3), t1, t2);
  });
}

// Returns the numbers of knots that are `apart_mm` apart along the path: the ends, the wanted one, and others in between.
export function handles_apart(knots, apart_mm, wanted = -1) {
  let sum = 0;
  const reached = knots.map((k, i) => i ? sum += Math.hypot(k.x - knots[i - 1].x, k.y - knots[i - 1].y) : 0);
  const kept = [...new Set([0, wanted, knots.length - 1])].filter(i => knots[i]);
  for (let i = 1; i < knots.length - 1; ++i) if (kept.every(k => Math.abs(reached[k] - reached[i]) >= apart_mm)) kept.push(i);
  return kept.sort((a, b) => a - b);
}

// Finds knots on a base: at its corners, and enough between them that spline and base stay within a tolerance of each other.
function find_knots(base, fit_mm = FIT_MM) {
  const rows = along(base.map(([t, x, y]) => [x, y, t]));
  const end_s = base.at(-1)[0];
  if (rows.length < 2) return [{x: base[0][1], y: base[0][2], corner: false, at: 0},
    {x: base[0][1] + 0.01, y: base[0][2], corner: false, at: end_s}];
  const total = rows.at(-1)[0], knot = (mm, corner) => {
    const [, x, y, t] = interpolate(rows, mm);
    return {mm, x, y, corner, at: mm === 0 ? 0 : mm === total ? end_s : t};
  };
  let knots = [knot(0, false), ...corners(rows).map(mm => knot(mm, true)), knot(total, false)];
  const fits = new Set(); // checked pieces, by the knots on which they depend
  for (let more = true; more;) {
    more = false;
    knots = knots.flatMap((k, i) => {
      const next = knots[i + 1], key = [k, ...knots.slice(Math.max(0, i - 1), i + 3)].map(q => q.mm).join();
      if (!next || fits.has(key)) return [k];
      const cut = place_to_cut(rows, knots, i, fit_mm);
      if (cut === null) { fits.add(key); return [k]; }
      more = true;
      return [k, knot(cut, false)];
    });
  }
  return knots.map(({x, y, corner, at}) => ({x, y, corner, at}));
}
// Returns the place of a further knot between knot i and the next one, mm along the path, or null if none is needed.
function place_to_cut(rows, knots, i, fit_mm) {
  const from = knots[i].mm, to = knots[i + 1].mm, long = to - from;
  if (long > LONGEST_MM) return (from + to) / 2;
  if (long < 2 * LOOK_MM) return null;
  const n = Math.ceil(long / LOOK_MM), curve = along(spline_piece(knots, i)), whole = curve.at(-1)[0];
  const places = (table, first, length) => sampled(n, part => interpolate(table, first + length * part).slice(1, 3));
  const path = places(rows, from, long), spline = places(curve, 0, whole);
  let worst = {off: fit_mm * 0.9, k: 0}; // keeps a margin for places between the samples
  for (let k = 0; k <= n; ++k) {
    const off = Math.max(from_line_mm(path[k], spline, k), from_line_mm(spline[k], path, k));
    if (off > worst.off) worst = {off, k};
  }
  if (!worst.k) return null;
  return from + long * clamp(worst.k / n, 0.2, 0.8);
}
// Returns the distance of a place from a line, near the number k of its places.
function from_line_mm(p, line, k) {
  const reach = 2 + Math.ceil(line.length / 4);
  let off = Infinity;
  for (let j = Math.max(0, k - reach); j < Math.min(line.length - 1, k + reach); ++j)
    off = Math.min(off, segment_mm(line[j], line[j + 1], p));
  return off;
}
// Returns the corners of a path, mm along it: turns of more than CORNER_RAD within 1 mm.
function corners(rows) {
  const total = rows.at(-1)[0], look = 0.5, found = [];
  for (const [mm] of rows) {
    if (mm < look || mm > total - look) continue;
    const by = turn(rows, mm, look);
    if (by <= CORNER_RAD) continue;
    const last = found.at(-1);
    if (!last || mm - last.mm > 2 * look) found.push({mm, by});
    else if (by > last.by) Object.assign(last, {mm, by});
  }
  return found.map(c => c.mm);
}
function turn(rows, at, look) {
  const [, ax, ay] = interpolate(rows, at - look), [, bx, by] = interpolate(rows, at), [, cx, cy] = interpolate(rows, at + look);
  const change = Math.atan2(cy - by, cx - bx) - Math.atan2(by - ay, bx - ax);
  return Math.abs(Math.atan2(Math.sin(change), Math.cos(change)));
}

// Returns a table of part of the path and part of the time, both from 0 to 1: "even", "soft" (in and out), "reach" (minimum jerk), "drawn" (a table
// [[part, time]]) and "points" (speeds [[part, relative speed]]).
export function pace_table(pace, n = 200) {
  if (pace.kind === "drawn") return pace.table;
  if (pace.kind === "points") {
    let t = 0;
    const table = sampled(n, part => [part, part && (t += 1 / Math.max(0.02, interpolate(pace.speeds, part - 0.5 / n)[1]))]);
    return table.map(([part, v]) => [part, v / t]);
  }
  if (pace.kind === "even") return [[0, 0], [1, 1]];
  const easing = {soft: v => v * v * (3 - 2 * v), reach: v => v ** 3 * (10 - 15 * v + 6 * v * v)}[pace.kind];
  return sampled(n, time => [easing(time), time]);
}

// Returns speeds at some parts of the path, relative to the mean speed, as movable points.
export function find_speeds(pace, n = 5) {
  if (pace.kind === "points") return pace.speeds;
  const table = pace_table(pace);
  return sampled(n - 1, part => {
    const a = Math.max(0, part - 0.06), b = Math.min(1, part + 0.06);
    const dt = interpolate(table, b)[1] - interpolate(table, a)[1];
    return [part, clamp((b - a) / Math.max(dt, 1e-3), 0.1, 5)];
  });
}

// Makes timed points from knots, pace, strength and duration.
export function rebuild(s, seconds = duration_s(s)) {
  const path = path_pieces(s).flatMap((rows, i) => i ? rows.slice(1) : rows);
  const own = JSON.stringify(s.strength) !== JSON.stringify(strength_table(s.base));
  const rows = along(path.map(([t, x, y, v]) => [x, y, v, t])), total = rows.at(-1)[0] || 1e-6;
  const strong = (part, v) => own ? interpolate(s.strength, part)[1] : v;
  if (s.pace.kind === "drawn") {
    let mm = 0;
    const by = seconds / duration_s({timed: s.base});
    return {...s, timed: thin(path.map(([t, x, y, v], i) => {
      if (i) mm += distance([x, y], path[i - 1].slice(1));
      return [t * by, x, y, strong(mm / total, v)];
    }))};
  }
  const table = pace_table(s.pace), by_time = table.map(([part, t]) => [t, part]);
  const n = clamp(Math.ceil(seconds / STEP_S), 2, MOST_POINTS);
  const cuts = new Set(sampled(n, part => part));
  for (const [, t] of table) cuts.add(t);
  for (const [mm] of rows) cuts.add(interpolate(table, mm / total)[1]);
  const timed = [...cuts].sort((a, b) => a - b).map(t => {
    const part = interpolate(by_time, t)[1], [, x, y, v] = interpolate(rows, part * total);
    return [t * seconds, x, y, strong(part, v)];
  });
  return {...s, timed: thin(timed)};
}

// Returns the times at which an editable stroke passes its knots, s from its start.
export const knot_times = kept_for(s => {
  if (s.pace.kind === "drawn") return s.knots.map(k => k.at * duration_s(s) / s.base.at(-1)[0]);
  let mm = 0;
  const reached = [0, ...path_pieces(s).map(rows => mm += length_mm(rows))];
  return reached.map(v => interpolate(pace_table(s.pace), v / (mm || 1))[1] * duration_s(s));
});

// Removes points that lie on the line between their neighbours in time, place and intensity.
export function thin(timed, tolerance = 0.02) {
  for (;;) {
    const kept = [timed[0]];
    // Works in ranges of at most 512 rows, so that the time stays linear.
    for (let from = 0; from + 1 < timed.length; from = Math.min(from + 512, timed.length - 1))
      kept.push(...needed_rows(timed, from, Math.min(from + 512, timed.length - 1), tolerance, TIMED_WEIGHTS));
    const rounded = kept.map(([t, x, y, v]) => [+t.toFixed(4), +x.toFixed(3), +y.toFixed(3), +v.toFixed(4)]);
    const out = rounded.filter((p, i) => i === 0 || p[0] > rounded[i - 1][0]);
    if (out.length === 1) out.push([out[0][0] + 0.001, ...rounded.at(-1).slice(1)]);
    if (out.length <= MOST_POINTS) return out;
    tolerance *= 2;
  }
}
// Returns the fewest rows after row a, up to b, such that between them no column, times its weight, is off by more than a tolerance.
function needed_rows(rows, a, b, tolerance, weights) {
  const stack = [[a, b]], needed = [];
  while (stack.length) {
    const [from, to] = stack.pop(), worst = farthest(rows, from, to, weights);
    if (worst.off > tolerance) stack.push([worst.at, to], [from, worst.at]);
    else if (to > from) needed.push(rows[to]);
  }
  return needed;
}
function farthest(rows, a, b, weights) {
  let off = 0, at = a;
  const p = rows[a], q = rows[b];
  for (let i = a + 1; i < b; ++i) {
    const r = rows[i], part = (r[0] - p[0]) / (q[0] - p[0] || 1);
    weights.forEach((weight, k) => {
      const d = weight * Math.abs(blend(p[k + 1], q[k + 1], part) - r[k + 1]);
      if (d > off) { off = d; at = i; }
    });
  }
  return {off, at};
}

// Makes a stroke editable: finds base, knots, pace and strength from its timed points, which stay the same.
export const editable = kept_for(s => {
  if (s.base) return s;
  const base = s.timed, table = [];
  for (const [part, time] of parts_reached(base)) {
    if (!table.length || part > table.at(-1)[0]) table.push([part, time]); else table.at(-1)[1] = time;
  }
  table[0][1] = 0; table.at(-1)[0] = 1; table.at(-1)[1] = 1;
  const even = !s.ink && table.every(([part, t]) => Math.abs(part - t) < 0.01);
  return {pace: even ? {kind: "even"} : {kind: "drawn", table: fewer(table, 0.004)}, strength: strength_table(base), ...s,
    base, knots: find_knots(base)};
});
// Returns the drawn strength along a path: [[part, factor], ...].
const strength_table = kept_for(base => {
  const strength = [];
  parts_reached(base).forEach(([part], i) => { if (!i || part > strength.at(-1)[0]) strength.push([part, base[i][3] ?? 1]); });
  strength.at(-1)[0] = 1;
  return fewer(strength, 0.03);
});
// Returns the fewest rows [v, w] that stay within a tolerance.
function fewer(rows, tolerance) {
  const out = [rows[0], ...needed_rows(rows, 0, rows.length - 1, tolerance, [1])];
  return out.length > 1 ? out : [[0, rows[0][1]], [1, rows[0][1]]];
}
// Makes a stroke that plays ink, [[t_s, x, y, intensity], ...], smoothed; its timing and its ends are kept.
export function from_drawing(ink, name, start_s = 0) {
  let low = 0;
  const smooth = ink.map(p => {
    const reach = Math.min(SMOOTH_S / 2, p[0] - ink[0][0], ink.at(-1)[0] - p[0]) + 1e-9, sum = [0, 0, 0, 0];
    while (ink[low][0] < p[0] - reach) ++low;
    while (low > 0 && ink[low - 1][0] >= p[0] - reach) --low;
    for (let i = low; i < ink.length && ink[i][0] <= p[0] + reach; ++i) {
      const weight = 1 - Math.abs(ink[i][0] - p[0]) / (reach + 1e-9);
      [1, ink[i][1], ink[i][2], ink[i][3]].forEach((v, k) => { sum[k] += weight * v; });
    }
    return [p[0], ...sum.slice(1).map(v => v / sum[0])];
  });
  return editable({name, start_s, timed: thin(smooth), ink});
}

// Returns how the path of a stroke differs from its ink: "drawn", "fitted", "edited", or null without ink.
export function shape(s) {
  if (!s?.ink) return null;
  if (s.placed || s.knots.some(k => k.moved)) return "edited";
  return s.knots[0].curve ? "fitted" : "drawn";
}
export const points_moved = s => (s.knots ?? []).filter(k => k.moved).length;
// Makes a stroke play its ink again, and keeps its edited form.
export function as_drawn(s) {
  const {edited: _, ...before} = s;
  return {...from_drawing(s.ink, s.name, s.start_s), ...s.keys && {keys: s.keys}, ...shape(s) === "edited" && {edited: before}};
}
// Restores the edited form of a stroke; without edits, makes it play the spline through its knots.
export const as_edited = s => s.edited ? {...s.edited, name: s.name, start_s: s.start_s} : rebuild({...s, knots: s.knots.map(k => ({...k, curve: true}))});

// Fits a curve with the fewest knots that stays within a tolerance of the base.
export const fitted_within = (s, fit_mm) => rebuild({...s, fit_mm, knots: find_knots(s.base, fit_mm).map(k => ({...k, curve: true}))});

// Changes knot i; the path becomes a spline on both sides of it, up to its neighbours, and stays the same elsewhere.
export const changed_knot = (s, i, change) => rebuild({...s, knots: s.knots.map((k, n) => ({...k,
  ...n === i && {...change, moved: true}, ...(n === i || n === i - 1) && {curve: true}}))});
export const without_knot = (s, i) => rebuild({...s, knots: s.knots.map((k, n) => n === i - 1 ? {...k, curve: true, moved: true} : k)
  .filter((_, n) => n !== i).map((k, n, all) => n === 0 ? {...k, at: 0} : n + 1 === all.length ? {...k, at: s.knots.at(-1).at} : k)});

export function straight(from, to, speed_mm_s, name, start_s, strength = 1) {
  const seconds = Math.max(0.06, distance(from, to) / speed_mm_s);
  return editable({name, start_s, timed: [[0, ...from, strength], [+seconds.toFixed(4), ...to, strength]]});
}

export function with_duration(s, seconds) {
  const timed = s.timed.map(p => [+(p[0] * seconds / duration_s(s)).toFixed(5), ...p.slice(1)]);
  return {...s, timed: timed.filter((p, i) => i === 0 || p[0] > timed[i - 1][0])};
}

// Cuts a stroke to a part of its time. Times from its own start.
export function trimmed(s, from_s, to_s) {
  const inside = s.timed.filter(p => p[0] > from_s && p[0] < to_s);
  const rows = [interpolate(s.timed, from_s), ...inside, interpolate(s.timed, to_s)];
  const timed = rows.map((p, i) => [i === 0 ? 0 : +((i === rows.length - 1 ? to_s : p[0]) - from_s).toFixed(5), ...p.slice(1)]);
  return {name: s.name, start_s: s.start_s + from_s, timed, ...s.ink && {ink: s.ink, placed: true}, ...s.keys && {keys: s.keys}};
}

// Returns the knot that is nearest to a place: {index, off}.
export const nearest_knot = (knots, place) => knots.reduce((best, k, index) => {
  const off = distance([k.x, k.y], place);
  return off < best.off ? {index, off} : best;
}, {index: -1, off: Infinity});
export function insert_knot(s, place) {
  let best = {off: Infinity};
  path_pieces(s).forEach((rows, after) => rows.forEach(([at, x, y]) => {
    const off = distance([x, y], place);
    if (off < best.off && at > s.knots[after].at && at < s.knots[after + 1].at) best = {after, off, at, x, y};
  }));
  if (best.off === Infinity) return {stroke: s, index: 0};
  const {after, at, x, y} = best;
  const knots = [...s.knots.slice(0, after + 1), {x, y, corner: false, at, curve: s.knots[after].curve}, ...s.knots.slice(after + 1)];
  return {stroke: rebuild({...s, knots}), index: after + 1};
}

// Scales and centres strokes to the box of a hull, but keeps their shape and times.
export function fitted(strokes, edge) {
  const all = strokes.flatMap(s => s.timed.map(p => [p[1], p[2]]));
  const from = box(all), to = box(edge);
  const room = k => to.size[k] > 1e-9 ? to.size[k] / Math.max(from.size[k], 1e-9) : Infinity;
  const by = Math.min(1e3, room(0), room(1));
  const move = (x, y) => [(x - from.middle[0]) * by + to.middle[0], (y - from.middle[1]) * by + to.middle[1]];
  const moved = timed => timed.map(([t, x, y, v]) => [t, ...move(x, y).map(c => +c.toFixed(3)), v]);
  return strokes.map(s => ({...s, timed: moved(s.timed), ...s.base && {base: moved(s.base)}, ...s.ink && {placed: true},
    ...s.knots && {knots: s.knots.map(k => { const [x, y] = move(k.x, k.y); return {...k, x, y}; })}}));
}
