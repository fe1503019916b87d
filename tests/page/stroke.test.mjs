// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import * as s from "../../src/server/page/takes/stroke.js";
import * as g from "../../src/server/page/geometry.js";
import {strokes_toml} from "../../src/server/page/takes/stroke_file.js";

const circle = (seconds = 2, n = 200) => Array.from({length: n + 1}, (_, i) => {
  const a = 2 * Math.PI * 0.75 * i / n;
  return [seconds * i / n, 20 + 16 * Math.cos(a), 20 + 16 * Math.sin(a), 1];
});
const farthest = (timed, target) => Math.max(...timed.map(p => { const q = s.interpolate(target, p[0]); return Math.hypot(p[1] - q[1], p[2] - q[2]); }));
const ascends = timed => timed.every((p, i) => i === 0 ? p[0] === 0 : p[0] > timed[i - 1][0]);

// A drawing at 60 Hz: f makes a place of a part, 0 to 1.
const drawing = (f, seconds = 2) => Array.from({length: Math.round(seconds * 60) + 1},
  (_, i) => [+(i / 60).toFixed(4), ...f(i / (seconds * 60)).map(v => +v.toFixed(3)), 1]);
const small_circle = a => [20 + 3 * Math.cos(2 * Math.PI * a), 20 + 3 * Math.sin(2 * Math.PI * a)];
const vibrato = a => [5 + 30 * a, 20 + Math.sin(2 * Math.PI * 8 * a)];
const zigzag = a => { const k = 10 * a % 2; return [5 + 20 * a, 20 + 3 * (k < 1 ? k : 2 - k)]; };
// The largest distance of the places of one path from another, mm.
const off_line = (from, to) => Math.max(...from.map(p => Math.min(...to.slice(1).map((b, i) => {
  const a = to[i], dx = b[1] - a[1], dy = b[2] - a[2], part = Math.min(1, Math.max(0, ((p[1] - a[1]) * dx + (p[2] - a[2]) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p[1] - a[1] - part * dx, p[2] - a[2] - part * dy);
}))));
const both_ways = (a, b) => Math.max(off_line(a, b), off_line(b, a));

test("a drawing plays its ink, in its time, and keeps it", () => {
  for (const f of [small_circle, vibrato, zigzag]) {
    const ink = drawing(f), drawn = s.from_drawing(ink, "as drawn");
    assert.equal(drawn.ink, ink);
    assert.ok(ascends(drawn.timed));
    assert.ok(Math.abs(s.duration_s(drawn) - 2) < 1e-3);
    assert.ok(farthest(drawn.timed, ink) < 0.05, `${farthest(drawn.timed, ink)} mm`);
    assert.ok(Math.abs(s.length_mm(drawn.timed) / s.length_mm(ink) - 1) < 0.01);
    assert.equal(s.shape(drawn), "drawn");
  }
});

test("noise of a fast pointer is smoothed over 12 ms, and a pen's pressure, too", () => {
  const ink = Array.from({length: 1001}, (_, i) => [i / 1000, 0.03 * i, i % 2 ? 0.3 : -0.3, i % 2 ? 1 : 0.6]);
  const drawn = s.from_drawing(ink, "noise").timed.filter(p => p[0] > 0.01 && p[0] < 0.99);
  assert.ok(drawn.every(p => Math.abs(p[2]) < 0.06 && Math.abs(p[3] - 0.8) < 0.05));
});

test("points lie so close that the curve stays within 0.2 mm of the drawing, both ways", () => {
  for (const [f, most] of [[small_circle, 10], [vibrato, 60], [zigzag, 14], [a => [5 + 30 * a, 20], 2]]) {
    const ink = drawing(f), drawn = s.from_drawing(ink, "fitted"), fitted = s.as_edited(drawn);
    assert.equal(s.shape(fitted), "fitted");
    assert.ok(both_ways(fitted.timed, ink) <= 0.2, `${both_ways(fitted.timed, ink)} mm`);
    assert.ok(farthest(fitted.timed, ink) < 0.5, `${farthest(fitted.timed, ink)} mm`);
    assert.ok(Math.abs(s.length_mm(fitted.timed) / s.length_mm(ink) - 1) < 0.05, `${s.length_mm(fitted.timed)} for ${s.length_mm(ink)} mm`);
    assert.ok(drawn.knots.length <= most, `${drawn.knots.length} points`);
    assert.deepEqual(s.as_drawn(fitted), drawn);
  }
  const fitted = s.as_edited(s.from_drawing(drawing(zigzag), "zigzag")), ink = drawing(zigzag);
  assert.equal(fitted.knots.filter(k => k.corner).length, 9);
  assert.ok(Math.abs(s.length_mm(fitted.timed) / s.length_mm(ink) - 1) < 0.01);
});

test("a moved point changes the path to its neighbours, and nothing else", () => {
  const drawn = s.from_drawing(drawing(vibrato), "vibrato"), i = Math.floor(drawn.knots.length / 2), k = drawn.knots;
  const moved = s.changed_knot(drawn, i, {x: k[i].x, y: k[i].y + 3});
  for (const p of drawn.timed) if (p[0] < k[i - 1].at || p[0] > k[i + 1].at)
    assert.ok(Math.hypot(...[1, 2].map(n => s.interpolate(moved.timed, p[0])[n] - p[n])) < 0.03);
  assert.ok(off_line([[0, k[i].x, k[i].y + 3]], moved.timed) < 0.03);
  assert.equal(s.duration_s(moved), s.duration_s(drawn));
  assert.deepEqual([s.shape(moved), s.points_moved(moved), moved.ink], ["edited", 1, drawn.ink]);
  const back = s.as_drawn(moved);
  assert.deepEqual(back.timed, drawn.timed);
  assert.deepEqual(s.as_edited(back), moved);
  assert.deepEqual(s.changed_knot(back, 0, {corner: true}).edited, moved);
});

test("what is fitted or trimmed plays as it was drawn, again", () => {
  const drawn = s.from_drawing(drawing(small_circle), "circle");
  for (const edited of [s.fitted([drawn], [[0, 0], [40, 0], [40, 40], [0, 40]])[0], s.trimmed(drawn, 0.5, 1.5)]) {
    assert.equal(s.shape(edited), "edited");
    assert.deepEqual(s.as_drawn(edited).timed, drawn.timed);
    assert.deepEqual(s.as_edited(s.as_drawn(edited)).timed, edited.timed);
  }
});

test("a drawing that stops half-way keeps its pace", () => {
  const raw = [...Array.from({length: 51}, (_, i) => [i / 100, i / 5, 0, 1]), ...Array.from({length: 50}, (_, i) => [1.5 + i / 100, 10 + (i + 1) / 5, 0, 1])];
  const drawn = s.from_drawing(raw, "stops");
  assert.ok(Math.abs(s.interpolate(drawn.timed, 1)[1] - 10) < 0.5);
  assert.ok(farthest(drawn.timed, raw) < 0.6, `${farthest(drawn.timed, raw)} mm`);
});

test("imported points are played as they are until they are edited", () => {
  const stroke = {name: "x", start_s: 0, timed: circle()}, ready = s.editable(stroke);
  assert.equal(ready.timed, stroke.timed);
  assert.equal(s.editable(ready), ready);
  assert.equal(ready.pace.kind, "even");
  assert.ok(farthest(s.rebuild(ready).timed, stroke.timed) < 0.3);
});

test("a knot is put in where the path is touched", () => {
  const stroke = s.from_drawing(circle(), "round"), at = s.interpolate(stroke.timed, 1).slice(1, 3);
  const added = s.insert_knot(stroke, at);
  assert.equal(added.stroke.knots.length, stroke.knots.length + 1);
  const k = added.stroke.knots[added.index];
  assert.ok(Math.hypot(k.x - at[0], k.y - at[1]) < 0.5);
  assert.ok(farthest(added.stroke.timed, stroke.timed) < 0.5);
});

test("paces begin, end and ascend; a reach is slow at its ends", () => {
  for (const kind of ["even", "soft", "reach"]) {
    const table = s.pace_table({kind});
    assert.deepEqual(table[0], [0, 0]);
    assert.deepEqual(table.at(-1), [1, 1]);
    assert.ok(table.every((r, i) => i === 0 || (r[0] >= table[i - 1][0] && r[1] >= table[i - 1][1])));
  }
  const speeds = s.find_speeds({kind: "reach"});
  assert.ok(speeds[0][1] < 0.5 && speeds[2][1] > 1.5);
  const twice = s.pace_table({kind: "points", speeds: [[0, 1], [0.49, 1], [0.51, 2], [1, 2]]});
  assert.ok(Math.abs(s.interpolate(twice, 0.5)[1] - 2 / 3) < 0.02);
});

test("strength changes along the path", () => {
  const stroke = s.rebuild({...s.editable({name: "x", start_s: 0, timed: circle()}), strength: [[0, 0.2], [0.5, 1], [1, 0]]});
  assert.ok(Math.abs(s.interpolate(stroke.timed, 1)[3] - 1) < 0.03);
  assert.ok(Math.abs(stroke.timed[0][3] - 0.2) < 1e-3);
  assert.equal(stroke.timed.at(-1)[3], 0);
});

test("a stroke is trimmed at times of its own, exactly", () => {
  const stroke = {name: "x", start_s: 1, timed: circle()}, cut = s.trimmed(stroke, 0.5, 1.5);
  assert.equal(cut.start_s, 1.5);
  assert.ok(Math.abs(s.duration_s(cut) - 1) < 1e-6);
  assert.ok(Math.hypot(...[1, 2].map(k => cut.timed[0][k] - s.interpolate(stroke.timed, 0.5)[k])) < 1e-6);
  assert.ok(ascends(cut.timed));
});

test("ten minutes of drawing stay below what a message may have, and their work grows with their length", () => {
  const drawn = rows => Array.from({length: rows}, (_, i) => [i / 60, 20 + 15 * Math.cos(i / 40), 20 + 15 * Math.sin(i / 23), 1]);
  const timed = ink => { const began = performance.now(), stroke = s.from_drawing(ink, "long"); return [stroke, performance.now() - began]; };
  timed(drawn(3600));
  const [, minute] = timed(drawn(3600)), [stroke, ten] = timed(drawn(36000));
  const toml = strokes_toml([stroke]);
  assert.ok(toml.length < 1 << 20, `${toml.length} bytes`);
  assert.ok(ascends(stroke.timed));
  assert.ok(Math.abs(s.duration_s(stroke) - 599.98) < 0.05);
  assert.ok(ten < 40 * minute, `${ten} ms, ${minute} ms for one minute`);
});

test("a tap that hardly moves, and one point twice, are strokes", () => {
  for (const raw of [[[0, 1, 1, 1], [0.2, 1, 1, 1]], [[0, 1, 1, 1], [0.1, 1.0001, 1, 1]], [[0, 0, 0, 1], [0.001, 30, 0, 1]]]) {
    const stroke = s.from_drawing(raw, "short");
    assert.ok(stroke.timed.length > 1 && ascends(stroke.timed), JSON.stringify(stroke.timed));
    assert.ok(stroke.timed.flat().every(Number.isFinite));
  }
});

test("a line has its speed, and is never shorter than 60 ms", () => {
  assert.ok(Math.abs(s.duration_s(s.straight([0, 0], [30, 0], 60, "l", 0)) - 0.5) < 1e-3);
  assert.ok(Math.abs(s.duration_s(s.straight([0, 0], [0.1, 0], 60, "l", 0)) - 0.06) < 1e-3);
});

test("the hull knows what lies outside of it", () => {
  const edge = g.hull([[0, 0], [20, 0], [40, 0], [0, 40], [40, 40], [20, 20]]);
  assert.equal(edge.length, 4);
  assert.equal(g.outside_mm(edge, [20, 20]), 0);
  assert.equal(g.outside_mm(edge, [40, 0]), 0);
  assert.ok(Math.abs(g.outside_mm(edge, [47, 20]) - 7) < 1e-9);
  assert.ok(Math.abs(g.outside_mm(g.hull([[0, 0], [30, 0]]), [10, 4]) - 4) < 1e-9);
});

test("strokes fit the array, on a single row, too", () => {
  const stroke = {name: "x", start_s: 0, timed: [[0, 0, 0, 1], [1, 200, 100, 1]]};
  const [square] = s.fitted([stroke], [[0, 0], [40, 0], [40, 40], [0, 40]]);
  assert.deepEqual(square.timed.map(p => p.slice(1, 3)), [[0, 10], [40, 30]]);
  const [row] = s.fitted([stroke], [[0, 0], [90, 0]]);
  assert.deepEqual([row.timed[0][1], row.timed[1][1]], [0, 90]);
});

test("names cannot break out of TOML", () => {
  const text = strokes_toml([{name: 'a"\n[x]\\', start_s: 2, timed: [[0, 1, 2, 1], [1, 3, 4, 0.5]]}]);
  assert.match(text, /^name = "a\\" \[x\]\\\\"$/m);
  assert.match(text, /^start_s = 2$/m); // its start is in the file
  assert.match(text, /^timed = \[\[0, 1, 2, 1\], \[1, 3, 4, 0.5\]\]$/m);
});

test("a corner shortly after the start takes nothing from the curve behind it", () => {
  const hook = [[0, 0, 8, 1], [0.05, 0, 0, 1], ...Array.from({length: 60}, (_, i) => [0.1 + i / 60, 0.6 * (i + 1), 3 * Math.sin(i / 8), 1])];
  const drawn = s.from_drawing(hook, "hook");
  assert.ok(drawn.knots[1].corner);
  for (const [fitted, within] of [[s.as_edited(drawn), 0.2], [s.fitted_within(drawn, 0.2), 0.2], [s.fitted_within(drawn, 2), 2]])
    assert.ok(both_ways(fitted.timed, drawn.timed) < within + 0.05, `${fitted.knots.length} points, ${both_ways(fitted.timed, drawn.timed)} mm off`);
});

test("handles are so far apart, and the ends and one that is wanted have one", () => {
  const knots = [0, 2, 9, 11, 19, 23, 31, 38, 40].map(x => ({x, y: 0}));
  assert.deepEqual(s.handles_apart(knots, 10), [0, 3, 5, 8]);
  assert.deepEqual(s.handles_apart(knots, 10, 4), [0, 4, 8]);
  assert.deepEqual(s.handles_apart(knots.slice(0, 2), 10), [0, 1]);
});
