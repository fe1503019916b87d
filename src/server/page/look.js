// SPDX-License-Identifier: MIT
// Icons, colours of the theme, and painting in them on a canvas.
import {make} from "../../net/page/dom.js";

// Icons as paths on a grid of 20.
const ICONS = {
  undo: "M8 5 4 9l4 4M4 9h7.5a4 4 0 0 1 0 8H10",
  redo: "M12 5l4 4-4 4M16 9H8.5a4 4 0 0 0 0 8H10",
  play: "M7 4.5v11l8.5-5.5z",
  fold: "M5 12.5l5-5 5 5",
  stop: "M5.5 5.5h9v9h-9z",
  loop: "M4 9V8a2.5 2.5 0 0 1 2.5-2.5H15M12.5 3 15 5.5 12.5 8M16 11v1a2.5 2.5 0 0 1-2.5 2.5H5M7.5 17 5 14.5 7.5 12",
  open: "M3 16V5a1 1 0 0 1 1-1h4l1.5 2H16a1 1 0 0 1 1 1v9a1 1 0 0 1-1 1H4a1 1 0 0 1-1-1z",
  share: "M3.5 3.5h5v5h-5zM11.5 3.5h5v5h-5zM3.5 11.5h5v5h-5zM11.5 11.5h2v2M16.5 11.5v2M11.5 16.5h2M16.5 16.5v-1",
  save: "M10 3v9.5M6 9l4 4 4-4M4 17h12",
  theme: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  help: "M10 17a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM7.8 8a2.2 2.2 0 1 1 3.2 2c-.7.4-1 .8-1 1.5M10 13.8v.1",
  people: "M7.5 9.5a2.8 2.8 0 1 0 0-5.5 2.8 2.8 0 0 0 0 5.5zM2.5 16.5v-1a4 4 0 0 1 4-4h2a4 4 0 0 1 4 4v1M13 4.3a2.8 2.8 0 0 1 0 5M14.5 11.8a4 4 0 0 1 3 3.7v1",
  plus: "M10 4v12M4 10h12",
  minus: "M4 10h12",
  all: "M3 7V4a1 1 0 0 1 1-1h3M13 3h3a1 1 0 0 1 1 1v3M17 13v3a1 1 0 0 1-1 1h-3M7 17H4a1 1 0 0 1-1-1v-3M7.5 10a2.5 2.5 0 1 0 5 0 2.5 2.5 0 0 0-5 0",
  more: "M5 10h.01M10 10h.01M15 10h.01",
  draw: "M3.5 16.5c3-9 4-11 6-11s0 8 2 8 2-6 5-7",
  line: "M5.5 14.5l9-9M3 17a2 2 0 1 0 3-3 2 2 0 0 0-3 3M14 6a2 2 0 1 0 3-3 2 2 0 0 0-3 3",
  points: "M3 15c0-6 4-9 8-9M11 3.5h4.5V8H11zM3 17a1.8 1.8 0 1 0 0-3.5M12 11l5 5.5-2.5.3-1.2 2.2z",
  felt: "M2 10h4M14 10h4M10 5.5l4.5 4.5-4.5 4.5L5.5 10z",
  feel: "M8 11V5.5a1.5 1.5 0 0 1 3 0V10l4 1a2 2 0 0 1 1.5 2.3l-.6 3.7H9.5L6 13a1.4 1.4 0 0 1 2-2zM5.5 6.5a4 4 0 0 1 8 0",
  speaker: "M3 8v4h3l4 3.5v-11L6 8zM13 7.5a3.5 3.5 0 0 1 0 5M15.2 5.2a7 7 0 0 1 0 9.6",
  warn: "M10 3.5 17.5 16.5h-15zM10 8v4M10 14.3v.1",
  close: "M5 5l10 10M15 5 5 15",
  curve: "M3 14c3-10 11-10 14 0",
  corner: "M3 15 10 5l7 10",
  bin: "M4 6h12M8 6V4h4v2M5.5 6l.8 11h7.4l.8-11M8.5 9v5M11.5 9v5",
  copy: "M7 7V4h9v9h-3M4 7h9v9H4z",
  rename: "M4 16l1-4 8.5-8.5 3 3L8 15z",
  settings: "M3 6h8M15 6h2M3 14h2M9 14h8M11 6a2 2 0 1 0 4 0 2 2 0 0 0-4 0M5 14a2 2 0 1 0 4 0 2 2 0 0 0-4 0",
  lock: "M5.5 9h9v7h-9zM7.5 9V6.5a2.5 2.5 0 0 1 5 0V9",
  check: "M4 10.5l4 4 8-9",
  running: "M10 17a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM10 13a3 3 0 1 0 0-6 3 3 0 0 0 0 6",
  ready: "M10 16a6 6 0 1 0 0-12 6 6 0 0 0 0 12z",
  barred: "M10 17a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM5 5l10 10",
  broken: "M8.5 11.5 6 14a2.5 2.5 0 0 1-3.5-3.5L5 8M11.5 8.5 14 6a2.5 2.5 0 0 1 3.5 3.5L15 12M4 4l1.5 1.5M14.5 14.5 16 16",
  muted: "M3 8v4h3l4 3.5v-11L6 8zM13 8l4 4M17 8l-4 4",
  waiting: "M10 17a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM10 6v4.5l3 2",
};

export function icon(name) {
  const p = make("path", {d: ICONS[name]});
  const filled = name === "play" || name === "stop";
  return make("svg", {class: `icon${filled ? " filled" : ""}${name === "more" ? " dots" : ""}`, viewBox: "0 0 20 20",
    "aria-hidden": "true"}, p);
}

// Puts icons into elements with data-icon.
export function place_icons(root = document) {
  for (const e of root.querySelectorAll("[data-icon]")) if (!e.querySelector(".icon")) e.prepend(icon(e.dataset.icon));
}

// Reads a colour of the theme.
let colours = {};
export function colour(name) {
  return colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
export function forget_colours() { colours = {}; }
export const is_dark = () => document.documentElement.dataset.theme === "dark";

// Paths and texts on a canvas, in pixels.
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
// Begins a path along several places, or around a single one.
export function plot(p, ...places) { p.beginPath(); for (const q of places) p.lineTo(...q); }
export function disc(p, [x, y], r) { p.beginPath(); p.arc(x, y, r, 0, 2 * Math.PI); }
