// SPDX-License-Identifier: MIT
// Colours of time: the same colour is the same moment everywhere.

const STOPS = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];

// Returns the colour at a part (0 to 1) of the time. The map is cut where it would vanish in the ground.
export function viridis(part, dark) {
  const at = (dark ? .2 + .8 * part : .9 * part) * (STOPS.length - 1), i = Math.min(STOPS.length - 2, Math.floor(at));
  const mixed = [16, 8, 0].map(shift => {
    const [a, b] = [STOPS[i], STOPS[i + 1]].map(colour => colour >> shift & 255);
    return Math.round(a + (at - i) * (b - a)).toString(16).padStart(2, "0");
  });
  return `#${mixed.join("")}`;
}
