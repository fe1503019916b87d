// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {viridis} from "../../src/net/page/viridis.js";

const parts = Array.from({length: 101}, (_, i) => i / 100);
const channels = colour => [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16));

// The relative luminance of WCAG 2.
function luminance(colour) {
  const [r, g, b] = channels(colour).map(c => c / 255).map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

test("colours are those of matplotlib", () => {
  // cm.viridis at 0, 0.2, 0.5, 0.9 and 1
  for (const [part, dark, expected] of [[0, false, "#440154"], [0, true, "#414487"], [0.5 / 0.9, false, "#21918c"], [1, false, "#bddf26"], [1, true, "#fde725"]])
    channels(viridis(part, dark)).forEach((c, i) => assert.ok(Math.abs(c - channels(expected)[i]) <= 2, `${part}: ${viridis(part, dark)}`));
});

test("later is lighter", () => {
  for (const dark of [false, true]) {
    const all = parts.map(p => luminance(viridis(p, dark)));
    all.slice(1).forEach((l, i) => assert.ok(l > all[i], `${dark} ${i}`));
  }
});

test("what is outside of the map has the colour of its end", () => {
  assert.equal(viridis(-1), viridis(0));
  assert.equal(viridis(2, true), viridis(1, true));
  assert.equal(viridis(NaN), viridis(0));
});
