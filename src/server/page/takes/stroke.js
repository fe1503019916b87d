// SPDX-License-Identifier: MIT
// Strokes as values. A stroke is {name, start_s, timed} and, once it can be edited, {knots, pace, strength}:
// timed is [[t_s, x_mm, y_mm, intensity], ...] and what is played; knots [{x, y, corner}] lie on its path;
// pace says when which part of the path is reached; strength is [[part, factor], ...].

const KNOT_MM = 8;
const STEP_MM = 0.5;
const STEP_S = 0.02;
const MOST_POINTS = 20000;
const TIMED_WEIGHTS = [1, 1, 4]; // of x, y and intensity
const CORNER_RAD = 0.9;

export const duration_s = s => s.timed.at(-1)[0];
export const end_s = s => s.start_s + duration_s(s);
export const total_s = strokes => strokes.reduce((most, s) => Math.max(most, end_s(s)), 0);

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const between = (a, b, part) => a + (b - a) * part;

// Finds the index of the last row whose first value is at most v, by halving.
function row_before(rows, v) {
  let low = 0, high = rows.length - 1;
  while (low < high) {
    const mid = (low + high + 1) >> 1;
    if (rows[mid][0] <= v) low = mid; else high = mid - 1;
  }
  return low;
}

// Returns a row of a table between two of its rows; at its ends the first or the last.
export function interpolate(rows, v) {
  if (v <= rows[0][0]) return rows[0];
  if (v >= rows.at(-1)[0]) return rows.at(-1);
  const i = row_before(rows, v), a = rows[i], b = rows[i + 1], part = (v - a[0]) / (b[0] - a[0] || 1);
  return a.map((x, k) => between(x, b[k], part));
}

// Makes a function of a value that is never changed: what it returned is kept as long as the value.
export function kept_for(f) {
  const kept = new WeakMap();
  return value => { if (!kept.has(value)) kept.set(value, f(value)); return kept.get(value); };
}
// Lengths of path until each point, mm.
const lengths_mm = kept_for(timed => {
  let sum = 0;
  return timed.map((p, i) => i ? sum += Math.hypot(p[1] - timed[i - 1][1], p[2] - timed[i - 1][2]) : 0);
});
export const length_mm = timed => lengths_mm(timed).at(-1);
// Parts of the path, and of the time, at each point. A path without a length goes on as time does.
export const parts_reached = kept_for(timed => {
  const total = length_mm(timed), seconds = timed.at(-1)[0];
  return timed.map((p, i) => [total > 0 ? lengths_mm(timed)[i] / total : p[0] / seconds, p[0] / seconds]);
});

// Returns [[length so far, x, y], ...] without points that stay.
function along(places) {
  const rows = [];
  let sum = 0;
  for (const [x, y] of places) {
    if (rows.length) {
      const d = distance([x, y], rows.at(-1).slice(1));
      if (d < 1e-6) continue;
      sum += d;
    }
    rows.push([sum, x, y]);
  }
  return rows;
}

// A spline through the knots (Catmull-Rom, centripetal), with corners, as places STEP_MM apart.
function curve_through(knots) {
  const out = [];
  for (let i = 0; i + 1 < knots.length; ++i) {
    const b = knots[i], c = knots[i + 1];
    const ends = c.corner || i + 2 === knots.length, begins = b.corner || i === 0;
    const a = !begins ? knots[i - 1] : ends ? mirrored(b, c) : bent(b, c, knots[i + 2]);
    const d = !ends ? knots[i + 2] : begins ? mirrored(c, b) : bent(c, b, knots[i - 1]);
    const steps = Math.max(1, Math.ceil(Math.hypot(c.x - b.x, c.y - b.y) / STEP_MM));
    for (let k = 0; k < steps; ++k) out.push(catmull_rom(a, b, c, d, k / steps));
  }
  const last = knots.at(-1);
  out.push([last.x, last.y]);
  return out;
}
// A place beyond an end, on the bend of the three knots there.
const bent = (at, next, then) => ({x: 3 * (at.x - next.x) + then.x, y: 3 * (at.y - next.y) + then.y});
const mirrored = (at, from) => ({x: 2 * at.x - from.x, y: 2 * at.y - from.y});
function catmull_rom(a, b, c, d, part) {
  const gap = (p, q) => Math.max(1e-4, Math.sqrt(Math.hypot(p.x - q.x, p.y - q.y)));
  const t1 = gap(a, b), t2 = t1 + gap(b, c), t3 = t2 + gap(c, d), t = between(t1, t2, part);
  return ["x", "y"].map(k => {
    const mix = (p, q, from, to) => ((to - t) * p + (t - from) * q) / (to - from);
    const ab = mix(a[k], b[k], 0, t1), bc = mix(b[k], c[k], t1, t2), cd = mix(c[k], d[k], t2, t3);
    return mix(mix(ab, bc, 0, t2), mix(bc, cd, t1, t3), t1, t2);
  });
}

// Knots each KNOT_MM along a path, and at its corners.
function find_knots(places, step = KNOT_MM) {
  const rows = along(places);
  if (rows.length < 2) return [{x: places[0][0], y: places[0][1], corner: false},
    {x: places.at(-1)[0] + 0.01, y: places.at(-1)[1], corner: false}];
  const total = rows.at(-1)[0], cuts = [0];
  const look = Math.min(2, total / 4);
  let last_corner = -look;
  for (let i = 1; i + 1 < rows.length; ++i) {
    const at = rows[i][0];
    if (at < look || at > total - look || at - last_corner < look) continue;
    if (turn(rows, at, look) > CORNER_RAD && turn(rows, at, look / 4) > CORNER_RAD * 0.8) { cuts.push(at); last_corner = at; }
  }
  cuts.push(total);
  const knots = [];
  cuts.forEach((cut, i) => {
    if (i > 0) {
      const span = cut - cuts[i - 1], n = Math.max(1, Math.round(span / step));
      for (let k = 1; k < n; ++k) knots.push(knot_at(rows, cuts[i - 1] + span * k / n, false));
    }
    knots.push(knot_at(rows, cut, i > 0 && i + 1 < cuts.length));
  });
  return knots;
}
function knot_at(rows, at, corner) {
  const [, x, y] = interpolate(rows, at);
  return {x, y, corner};
}
function turn(rows, at, look) {
  const [, ax, ay] = interpolate(rows, at - look), [, bx, by] = interpolate(rows, at), [, cx, cy] = interpolate(rows, at + look);
  const a = Math.atan2(by - ay, bx - ax), b = Math.atan2(cy - by, cx - bx);
  return Math.abs(Math.atan2(Math.sin(b - a), Math.cos(b - a)));
}

// Returns when which part of the path is reached, both from 0 to 1: "even", "soft" (in and out), "reach" (minimum jerk),
// "drawn" (a table [[part, time]]) and "points" (speeds [[part, relative speed]]).
export function pace_table(pace, n = 200) {
  if (pace.kind === "drawn") return pace.table;
  if (pace.kind === "points") {
    let t = 0;
    const table = [[0, 0]];
    for (let i = 1; i <= n; ++i) {
      t += 1 / Math.max(0.02, interpolate(pace.speeds, (i - 0.5) / n)[1]);
      table.push([i / n, t]);
    }
    return table.map(([part, v]) => [part, v / t]);
  }
  const easing = {even: v => v, soft: v => v * v * (3 - 2 * v), reach: v => v ** 3 * (10 - 15 * v + 6 * v * v)}[pace.kind];
  if (pace.kind === "even") return [[0, 0], [1, 1]];
  return Array.from({length: n + 1}, (_, i) => [easing(i / n), i / n]);
}

// Speeds, relative to the mean one, at some parts of the path; their points can be moved.
export function find_speeds(pace, n = 5) {
  if (pace.kind === "points") return pace.speeds;
  const table = pace_table(pace);
  return Array.from({length: n}, (_, i) => {
    const part = i / (n - 1), a = Math.max(0, part - 0.06), b = Math.min(1, part + 0.06);
    const dt = interpolate(table, b)[1] - interpolate(table, a)[1];
    return [part, Math.min(5, Math.max(0.1, (b - a) / Math.max(dt, 1e-3)))];
  });
}

// Makes timed points of knots, pace, strength and duration.
export function rebuild(s, seconds = duration_s(s)) {
  const rows = along(curve_through(s.knots));
  const total = rows.at(-1)[0] || 1e-6, table = pace_table(s.pace).map(([part, t]) => [t, part]);
  const n = Math.min(MOST_POINTS, Math.max(2, Math.ceil(total / STEP_MM), Math.ceil(seconds / STEP_S)));
  const cuts = new Set(Array.from({length: n + 1}, (_, i) => i / n));
  for (const [t] of table) if (table.length < 400) cuts.add(t);
  const timed = [...cuts].sort((a, b) => a - b).map(t => {
    const part = interpolate(table, t)[1], [, x, y] = interpolate(rows, part * total);
    return [t * seconds, x, y, interpolate(s.strength, part)[1]];
  });
  return {...s, timed: thin(timed)};
}

// Leaves out points that lie on the line of their neighbours in time, place and intensity.
export function thin(timed, tolerance = 0.02) {
  for (;;) {
    const kept = [timed[0]];
    // Ranges of at most 512 rows, so that the work stays linear.
    for (let from = 0; from + 1 < timed.length; from = Math.min(from + 512, timed.length - 1))
      kept.push(...needed_rows(timed, from, Math.min(from + 512, timed.length - 1), tolerance, TIMED_WEIGHTS));
    const rounded = kept.map(([t, x, y, v]) => [+t.toFixed(4), +x.toFixed(3), +y.toFixed(3), +v.toFixed(4)]);
    const out = rounded.filter((p, i) => i === 0 || p[0] > rounded[i - 1][0]);
    if (out.length === 1) out.push([out[0][0] + 0.001, ...rounded.at(-1).slice(1)]);
    if (out.length <= MOST_POINTS) return out;
    tolerance *= 2;
  }
}
// Returns the fewest rows after row a, until b, between which no column, by its weight, is off by more than a tolerance.
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
      const d = weight * Math.abs(between(p[k + 1], q[k + 1], part) - r[k + 1]);
      if (d > off) { off = d; at = i; }
    });
  }
  return {off, at};
}

// Gives a stroke what editing needs, found from its timed points. The path comes within some tenths of a millimetre.
export function editable(s) {
  if (s.knots) return s;
  const rows = along(s.timed.map(p => [p[1], p[2]]));
  const table = [], strength = [];
  parts_reached(s.timed).forEach(([part, time], i) => {
    if (!table.length || part > table.at(-1)[0]) { table.push([part, time]); strength.push([part, s.timed[i][3] ?? 1]); }
    else table.at(-1)[1] = Math.max(table.at(-1)[1], time);
  });
  table[0][1] = 0; table.at(-1)[0] = 1; table.at(-1)[1] = 1; strength.at(-1)[0] = 1;
  const even = table.every(([part, t]) => Math.abs(part - t) < 0.01);
  return {...s, knots: find_knots(rows.length > 1 ? rows.map(r => [r[1], r[2]]) : s.timed.map(p => [p[1], p[2]])),
    pace: even ? {kind: "even"} : {kind: "drawn", table: fewer(table, 0.004)}, strength: fewer(strength, 0.03)};
}
// The fewest rows [v, w] that stay within a tolerance.
function fewer(rows, tolerance) {
  const out = [rows[0], ...needed_rows(rows, 0, rows.length - 1, tolerance, [1])];
  return out.length > 1 ? out : [[0, rows[0][1]], [1, rows[0][1]]];
}
// A stroke as it was drawn: raw is [[t_s, x, y, intensity], ...]; smoothed, its timing kept.
export function from_drawing(raw, name, start_s = 0) {
  const smooth = raw.map((p, i) => {
    if (i === 0 || i + 1 === raw.length) return p;
    const mean = k => (raw[i - 1][k] + 2 * p[k] + raw[i + 1][k]) / 4;
    return [p[0], mean(1), mean(2), mean(3)];
  });
  return rebuild(editable({name, start_s, timed: smooth}));
}

export function straight(from, to, speed_mm_s, name, start_s, strength = 1) {
  const knots = [{x: from[0], y: from[1], corner: false}, {x: to[0], y: to[1], corner: false}];
  const seconds = Math.max(0.06, Math.hypot(to[0] - from[0], to[1] - from[1]) / speed_mm_s);
  return rebuild({name, start_s, knots, pace: {kind: "even"}, strength: [[0, strength], [1, strength]],
    timed: [[0, 0, 0, 1], [seconds, 0, 0, 1]]});
}

export const with_duration = (s, seconds) => ({...s, timed: scaled(s.timed, seconds / duration_s(s))});
function scaled(timed, by) {
  const out = timed.map(p => [+(p[0] * by).toFixed(5), ...p.slice(1)]);
  return out.filter((p, i) => i === 0 || p[0] > out[i - 1][0]);
}

// Cuts a stroke to a part of its time. Times from its own start.
export function trimmed(s, from_s, to_s) {
  const inside = s.timed.filter(p => p[0] > from_s && p[0] < to_s);
  const rows = [interpolate(s.timed, from_s), ...inside, interpolate(s.timed, to_s)];
  const timed = rows.map((p, i) => [i === 0 ? 0 : +((i === rows.length - 1 ? to_s : p[0]) - from_s).toFixed(5), ...p.slice(1)]);
  return {name: s.name, start_s: s.start_s + from_s, timed};
}

// The knot, or the place between two, that is nearest to a place: {index, off} and {after, off}.
export function nearest_knot(knots, [x, y]) {
  return knots.reduce((best, k, index) => {
    const off = Math.hypot(k.x - x, k.y - y);
    return off < best.off ? {index, off} : best;
  }, {index: -1, off: Infinity});
}
export function insert_knot(s, [x, y]) {
  let best = {after: 0, off: Infinity};
  for (let i = 0; i + 1 < s.knots.length; ++i)
    for (const [px, py] of curve_through(s.knots.slice(Math.max(0, i - 1), i + 3)))
      if (Math.hypot(px - x, py - y) < best.off) best = {after: i, off: Math.hypot(px - x, py - y), x: px, y: py};
  // It lies between the pair of neighbours whose way through it is the shortest.
  let pair = {after: 0, way: Infinity};
  for (let i = 0; i + 1 < s.knots.length; ++i) {
    const a = s.knots[i], b = s.knots[i + 1];
    const way = Math.hypot(a.x - best.x, a.y - best.y) + Math.hypot(b.x - best.x, b.y - best.y) - Math.hypot(a.x - b.x,
      a.y - b.y);
    if (way < pair.way) pair = {after: i, way};
  }
  const knots = [...s.knots.slice(0, pair.after + 1), {x: best.x, y: best.y, corner: false}, ...s.knots.slice(pair.after + 1)];
  return {stroke: rebuild({...s, knots}), index: pair.after + 1};
}

// The convex hull of places, counter-clockwise in the mathematical sense.
export function hull(places) {
  const sorted = [...places].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = list => {
    const out = [];
    for (const p of list) {
      while (out.length > 1 && cross(out.at(-2), out.at(-1), p) <= 1e-9) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return [...half(sorted), ...half([...sorted].reverse())];
}
const cross = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

// The distance of a place from a hull; 0 within.
export function outside_mm(edge, p) {
  if (edge.length < 3) return edge.length === 2 ? segment_mm(edge[0], edge[1], p) : 0;
  let off = Infinity, inside = true;
  edge.forEach((a, i) => {
    const b = edge[(i + 1) % edge.length];
    if (cross(a, b, p) < -1e-9) inside = false;
    off = Math.min(off, segment_mm(a, b, p));
  });
  return inside ? 0 : off;
}
function segment_mm(a, b, p) {
  const dx = b[0] - a[0], dy = b[1] - a[1];
  const part = Math.min(1, Math.max(0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p[0] - a[0] - part * dx, p[1] - a[1] - part * dy);
}

// Scales and centres strokes to the box of a hull, and keeps their shape and their times.
export function fitted(strokes, edge) {
  const all = strokes.flatMap(s => s.timed.map(p => [p[1], p[2]]));
  const from = box(all), to = box(edge);
  const room = k => to.size[k] > 1e-9 ? to.size[k] / Math.max(from.size[k], 1e-9) : Infinity;
  const by = Math.min(1e3, ...[room(0), room(1)].filter(v => Number.isFinite(v)));
  const move = (x, y) => [(x - from.middle[0]) * by + to.middle[0], (y - from.middle[1]) * by + to.middle[1]];
  return strokes.map(s => ({...s,
    timed: s.timed.map(([t, x, y, v]) => [t, ...move(x, y).map(c => +c.toFixed(3)), v]),
    ...s.knots && {knots: s.knots.map(k => { const [x, y] = move(k.x, k.y); return {...k, x, y}; })}}));
}
export function box(places) {
  const xs = places.map(p => p[0]), ys = places.map(p => p[1]);
  const least = [min(xs), min(ys)], most = [max(xs), max(ys)];
  return {least, most, size: [most[0] - least[0], most[1] - least[1]], middle: [(least[0] + most[0]) / 2,
    (least[1] + most[1]) / 2]};
}
const min = list => list.reduce((a, b) => Math.min(a, b), Infinity);
const max = list => list.reduce((a, b) => Math.max(a, b), -Infinity);

// TOML and CSV of strokes.
const quoted = text => `"${String(text).replace(/[\u0000-\u001f\u007f]/g, " ").replace(/[\\"]/g, "\\$&")}"`;
export function strokes_toml(strokes) {
  const ordered = [...strokes].sort((a, b) => a.start_s - b.start_s), first = ordered[0]?.start_s ?? 0;
  return ordered.map(s => `[[stroke]]\nname = ${quoted(s.name)}\nstart_s = ${+(s.start_s - first).toFixed(4)}\nstart_from = "piece"\n` +
    `timed = [${s.timed.map(p => `[${p.join(", ")}]`).join(", ")}]\n`).join("\n");
}
export const stroke_csv = s => "t_s,x_mm,y_mm,intensity\n" + s.timed.map(p => p.join(",")).join("\n") + "\n";
