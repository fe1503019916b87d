// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import * as s from "../../src/server/page/takes/stroke.js";

const circle = (seconds = 2, n = 200) => Array.from({length: n + 1}, (_, i) => {
  const a = 2 * Math.PI * 0.75 * i / n;
  return [seconds * i / n, 20 + 16 * Math.cos(a), 20 + 16 * Math.sin(a), 1];
});
const farthest = (timed, target) => Math.max(...timed.map(p => { const q = s.interpolate(target, p[0]); return Math.hypot(p[1] - q[1], p[2] - q[2]); }));
const ascends = timed => timed.every((p, i) => i === 0 ? p[0] === 0 : p[0] > timed[i - 1][0]);

test("a drawing is smoothed, has a knot each 8 mm, and keeps its timing", () => {
  const drawn = s.from_drawing(circle(), "round");
  assert.ok(ascends(drawn.timed));
  assert.ok(Math.abs(s.duration_s(drawn) - 2) < 1e-3);
  assert.ok(farthest(drawn.timed, circle()) < 0.3, `${farthest(drawn.timed, circle())} mm`);
  assert.ok(Math.abs(drawn.knots.length - 1 - 75.4 / 8) < 1);
});

test("a drawing that stops half-way keeps its pace", () => {
  const raw = [...Array.from({length: 51}, (_, i) => [i / 100, i / 5, 0, 1]), ...Array.from({length: 50}, (_, i) => [1.5 + i / 100, 10 + (i + 1) / 5, 0, 1])];
  const drawn = s.from_drawing(raw, "stops");
  assert.ok(Math.abs(s.interpolate(drawn.timed, 1)[1] - 10) < 0.5);
  assert.ok(farthest(drawn.timed, raw) < 0.6, `${farthest(drawn.timed, raw)} mm`);
});

test("a corner stays a corner", () => {
  const raw = [...Array.from({length: 41}, (_, i) => [i / 40, i / 2, 0, 1]), ...Array.from({length: 40}, (_, i) => [1 + (i + 1) / 40, 20, (i + 1) / 2, 1])];
  const drawn = s.from_drawing(raw, "corner");
  assert.equal(drawn.knots.filter(k => k.corner).length, 1);
  assert.ok(Math.min(...drawn.timed.map(p => Math.hypot(p[1] - 20, p[2]))) < 0.6);
});

test("imported points are played as they are until they are edited", () => {
  const stroke = {name: "x", start_s: 0, timed: circle()}, ready = s.editable(stroke);
  assert.equal(ready.timed, stroke.timed);
  assert.equal(s.editable(ready), ready);
  assert.equal(ready.pace.kind, "even");
  assert.ok(farthest(s.rebuild(ready).timed, stroke.timed) < 0.3);
});

test("a moved knot moves the path there and leaves the duration", () => {
  const stroke = s.from_drawing(circle(), "round"), k = 4;
  const moved = s.rebuild({...stroke, knots: stroke.knots.map((q, i) => i === k ? {...q, x: 5, y: 5} : q)});
  assert.ok(Math.min(...moved.timed.map(p => Math.hypot(p[1] - 5, p[2] - 5))) < 0.5);
  assert.ok(Math.abs(s.duration_s(moved) - s.duration_s(stroke)) < 1e-3);
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

test("ten minutes of drawing stay below what a message may have, and take a moment", () => {
  const raw = Array.from({length: 36000}, (_, i) => [i / 60, 20 + 15 * Math.cos(i / 40), 20 + 15 * Math.sin(i / 23), 1]);
  const began = performance.now(), stroke = s.from_drawing(raw, "long"), took = performance.now() - began;
  const toml = s.strokes_toml([stroke]);
  assert.ok(toml.length < 1 << 20, `${toml.length} bytes`);
  assert.ok(ascends(stroke.timed));
  assert.ok(Math.abs(s.duration_s(stroke) - 599.98) < 0.05);
  assert.ok(took < 10000, `${took} ms`);
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
  const edge = s.hull([[0, 0], [20, 0], [40, 0], [0, 40], [40, 40], [20, 20]]);
  assert.equal(edge.length, 4);
  assert.equal(s.outside_mm(edge, [20, 20]), 0);
  assert.equal(s.outside_mm(edge, [40, 0]), 0);
  assert.ok(Math.abs(s.outside_mm(edge, [47, 20]) - 7) < 1e-9);
  assert.ok(Math.abs(s.outside_mm(s.hull([[0, 0], [30, 0]]), [10, 4]) - 4) < 1e-9);
});

test("strokes fit the array, on a single row, too", () => {
  const stroke = {name: "x", start_s: 0, timed: [[0, 0, 0, 1], [1, 200, 100, 1]]};
  const [square] = s.fitted([stroke], [[0, 0], [40, 0], [40, 40], [0, 40]]);
  assert.deepEqual(square.timed.map(p => p.slice(1, 3)), [[0, 10], [40, 30]]);
  const [row] = s.fitted([stroke], [[0, 0], [90, 0]]);
  assert.deepEqual([row.timed[0][1], row.timed[1][1]], [0, 90]);
});

test("names cannot break out of TOML", () => {
  const text = s.strokes_toml([{name: 'a"\n[x]\\', start_s: 2, timed: [[0, 1, 2, 1], [1, 3, 4, 0.5]]}]);
  assert.match(text, /^name = "a\\" \[x\]\\\\"$/m);
  assert.match(text, /^start_s = 0$/m);
  assert.match(text, /^timed = \[\[0, 1, 2, 1\], \[1, 3, 4, 0.5\]\]$/m);
});
