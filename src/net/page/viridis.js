// SPDX-License-Identifier: MIT
// Colours of time: the map "viridis" of matplotlib (CC0), cut at the end that would be invisible on the background.

// Colours of the map, 33 at even distances; linear interpolation is within 2 of 255.
const VIRIDIS = [
  "440154 470d60 48186a 482374 472d7b 453681 424086 3f4989 3b528b 375a8d 33638d",
  "2f6a8e 2c728e 297a8e 26818e 23898e 21908c 1f988b 1f9f88 21a685 28ae80 31b57b",
  "3ebc74 4cc26c 5dc963 6ece58 82d34c 96d83f abdc32 c0df24 d5e21a eae51a fde725"
].join(" ").split(" ").map(c => [0, 2, 4].map(i => parseInt(c.slice(i, i + 2), 16)));

// Returns the colour of a part from 0 to 1 as "#rrggbb": of 0 to 0.9 of the map on light ground, of 0.2 to 1 on dark ground.
export function viridis(part, dark = false) {
  const within = Math.min(1, Math.max(0, part || 0));
  const at = (dark ? 0.2 + 0.8 * within : 0.9 * within) * (VIRIDIS.length - 1);
  const i = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const mixed = VIRIDIS[i].map((c, k) => Math.round(c + (VIRIDIS[i + 1][k] - c) * (at - i)));
  return `#${mixed.map(c => c.toString(16).padStart(2, "0")).join("")}`;
}
