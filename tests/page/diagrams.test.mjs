// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {window_at} from "../../src/server/page/settings/diagrams.js";

test("the picture of a burst has the window that is played", () => {
  const half = 0.5 - 0.5 * Math.cos(Math.PI / 2), early = (1 - Math.exp(-2.5)) / (1 - Math.exp(-5));
  for (const [kind, rises, falls] of [["linear", 0.5, 0.5], ["raised-cosine", half, half], ["exponential", early, 1 - early]]) {
    assert.deepEqual([0, 0.1, 0.5, 0.8, 1].map(v => window_at(v, 0.2, 0.4, kind).toFixed(9)),
      [0, rises, 1, falls, 0].map(v => v.toFixed(9)), kind);
    assert.ok(Math.abs(window_at(0.375, 1.5, 0.5, kind) - rises) < 1e-12, "ramps that do not fit are shortened alike");
    assert.equal(window_at(0, 0, 0, kind), 1);
  }
});
