// SPDX-License-Identifier: MIT
// Small pictures, computed from the formulas that they explain.
import {make} from "../../../net/page/dom.js";
import {is_dark} from "../look.js";
import {sampled} from "../geometry.js";
import {viridis} from "../../../net/page/viridis.js";

const picture = (width, height, ...parts) => make("svg", {viewBox: `0 0 ${width} ${height}`, class: "diagram",
  "aria-hidden": "true"}, ...parts);
const line = (points, attributes = {}) => make("polyline",
  {points: points.map(p => p.map(v => v.toFixed(1)).join(",")).join(" "), fill: "none", stroke: "currentColor",
  "stroke-width": 1.6, "stroke-linecap": "round", "stroke-linejoin": "round", ...attributes});
const base = y => line([[1, y], [55, y]], {stroke: "var(--line2)", "stroke-width": 1});
const tone = part => viridis(part, is_dark());

// Draws the times at which two tactors play while a stroke passes them.
export function algorithm_picture(name) {
  const parts = [base(17), base(35)];
  if (name === "park2016") {
    for (let i = 0; i < 5; ++i) {
      const w = (i + 0.5) / 5, a = [Math.sqrt(1 - w), Math.sqrt(w)];
      a.forEach((v, k) => parts.push(make("rect", {x: 4 + i * 10, y: 17 + 18 * k - v * 15, width: 9, height: v * 15,
        fill: tone(i / 5)})));
    }
  } else if (name === "tactile-brush") {
    [[2, 17, 0.1], [34, 17, 0.75], [18, 35, 0.42]].forEach(([x, y, part]) => parts.push(make("path",
      {d: `M${x} ${y}l4-14h13l4 14z`, fill: tone(part)})));
  } else {
    const areas = [v => Math.sqrt(1 - v), v => Math.sqrt(v)];
    areas.forEach((f, k) => {
      for (let i = 0; i < 26; ++i) parts.push(make("rect", {x: 2 + i * 2, y: 17 + 18 * k - f(i / 25) * 15, width: 2.2,
        height: Math.max(0.01, f(i / 25) * 15), fill: tone(i / 25)}));
    });
  }
  return picture(56, 36, ...parts);
}
// Returns the window of a burst at a part of its duration. Rise and fall are parts of the duration, too.
export function window_at(part, rise, fall, kind) {
  const shorter = Math.min(1, 1 / (rise + fall)), up = rise * shorter, down = fall * shorter;
  const ramp = v => kind === "linear" ? v : kind === "exponential" ? (1 - Math.exp(-5 * v)) / (1 - Math.exp(-5))
    : 0.5 - 0.5 * Math.cos(Math.PI * v);
  if (part < up) return ramp(part / up);
  if (part <= 1 - down) return 1;
  const left = (1 - part) / down;
  return kind === "exponential" ? 1 - ramp(1 - left) : ramp(left);
}
// Draws one burst with its carrier.
export function envelope_picture(burst_s, attack_s, release_s, carrier_hz, kind) {
  const at = v => window_at(v, attack_s / burst_s, release_s / burst_s, kind);
  const cycles = Math.min(40, burst_s * carrier_hz);
  const wave = sampled(600, part => [14 + 268 * part, 40 - 30 * at(part) * Math.sin(2 * Math.PI * cycles * part)]);
  const top = sampled(120, part => [14 + 268 * part, 40 - 30 * at(part)]);
  return picture(296, 80, line(wave, {stroke: "var(--ink3)", "stroke-width": 0.9}), line(top, {"stroke-width": 2}));
}
