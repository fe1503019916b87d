// SPDX-License-Identifier: MIT
// Paths and texts on a canvas, in pixels and in colours of the theme.
import {colour} from "../look.js";

let family = "";
export const font = (size, weight = 400) => `${weight} ${size}px ${family ||= getComputedStyle(document.body).fontFamily}`;
// Fills the path of a canvas and draws its line, in colours of the theme.
export function paint(p, {fill, line, width = 1, alpha = 1}) {
  p.globalAlpha = alpha;
  if (fill) { p.fillStyle = colour(fill); p.fill(); }
  if (line) { p.strokeStyle = colour(line); p.lineWidth = width; p.stroke(); }
  p.globalAlpha = 1;
}
export function write(p, text, x, y, tone, {size = 12, weight = 400, align = "center"} = {}) {
  Object.assign(p, {font: font(size, weight), textAlign: align, fillStyle: colour(tone)});
  p.fillText(text, x, y);
}
// Begins a path along places, or around one.
export function plot(p, ...places) { p.beginPath(); for (const q of places) p.lineTo(...q); }
export function disc(p, [x, y], r) { p.beginPath(); p.arc(x, y, r, 0, 2 * Math.PI); }
