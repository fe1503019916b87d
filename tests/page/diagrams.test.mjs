// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {shares_at, window_at} from "../../src/server/page/settings/diagrams.js";
import {PHANTOMS} from "../../src/server/page/words.js";

// Amplitudes of tactor 0 and of each of the two others in plans of points on an array of three tactors, 40 mm apart, that lie these
// parts of the way from tactor 0 to the middle between the others.
const PARTS = [0, 0.25, 0.5, 1];
const PLANNED = {
  "inverse-distance": [[1, 0], [0.8089, 0.4157], [0.6581, 0.5324], [0, 0.7071]],
  "barycentric": [[1, 0], [0.866, 0.3536], [0.7071, 0.5], [0, 0.7071]],
  "linear": [[1, 0], [0.75, 0.125], [0.5, 0.25], [0, 0.5]],
  "log": [[1, 0], [0.8074, 0.1699], [0.585, 0.3219], [0, 0.585]],
  "gaussian": [[0.9431, 0.2352], [0.8599, 0.361], [0.7073, 0.4998], [0.3329, 0.6668]],
};

test("the picture of a phantom has the amplitudes of its plans, and no two are alike", () => {
  assert.deepEqual(Object.keys(PLANNED), Object.keys(PHANTOMS));
  for (const [name, planned] of Object.entries(PLANNED))
    PARTS.forEach((part, i) => shares_at(name, part).forEach((a, k) =>
      assert.ok(Math.abs(a - planned[i][k]) < 1e-4, `${name} at ${part}: ${a}, not ${planned[i][k]}`)));
  assert.equal(new Set(Object.keys(PLANNED).map(name => shares_at(name, 0.25).join())).size, 5);
});

test("the picture of a burst has the window that is played", () => {
  const half = 0.5 - 0.5 * Math.cos(Math.PI / 2), early = (1 - Math.exp(-2.5)) / (1 - Math.exp(-5));
  for (const [kind, rises, falls] of [["linear", 0.5, 0.5], ["raised-cosine", half, half], ["exponential", early, 1 - early]]) {
    assert.deepEqual([0, 0.1, 0.5, 0.8, 1].map(v => window_at(v, 0.2, 0.4, kind).toFixed(9)),
      [0, rises, 1, falls, 0].map(v => v.toFixed(9)), kind);
    assert.ok(Math.abs(window_at(0.375, 1.5, 0.5, kind) - rises) < 1e-12, "ramps that do not fit are shortened alike");
    assert.equal(window_at(0, 0, 0, kind), 1);
  }
});
