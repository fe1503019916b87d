// SPDX-License-Identifier: MIT
// The array to scale: millimetres to pixels, zoom, and the layers that are drawn again when something changes.
import {state, changed, on_change} from "../state.js";
import {by_id} from "../../../net/page/dom.js";
import {box, clamp, distance, hull} from "../geometry.js";
import {body_corners} from "./body.js";

const canvas = by_id("field");
export const layers = {ground: by_id("ground"), ink: by_id("ink"), moment: canvas}; // each lies over the previous one
export const view = {zoom: 1, x: 0, y: 0, scale: 1, left: 0, top: 0, width: 0, height: 0, dpr: 1, scale_bottom: 20, scale_left: 18};
export const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}; // keys
export const stale = {ground: true, ink: true};
export let array = null; // {tactors, edge, pitch, radius}

export function set_array(a) {
  const places = a.tactors.map(t => [t.x_mm, t.y_mm]);
  let pitch = Infinity;
  places.forEach((p, i) => places.slice(i + 1).forEach(q => { pitch = Math.min(pitch, distance(p, q) || Infinity); }));
  if (pitch === Infinity) pitch = 40;
  array = {...a, places, edge: hull(places), box: box(places), pitch, radius: pitch * 0.215};
  look_at_all();
}
export const to_px = ([x, y]) => [view.left + (x - array.box.middle[0]) * view.scale,
  view.top + (y - array.box.middle[1]) * view.scale];
export const to_mm = (px, py) => [(px - view.left) / view.scale + array.box.middle[0],
  (py - view.top) / view.scale + array.box.middle[1]];
export const place_in_page = p => { const r = canvas.getBoundingClientRect(), [x, y] = to_px(p); return [r.left + x, r.top + y]; };
export const handle_px = () => Math.max(...array.box.size) / 2 * view.scale + 44; // distance of the handle that turns the body from the middle of the array
export function tactor_at(at) {
  return array ? array.places.findIndex(p => distance(p, at) <= array.radius * 1.05) : -1;
}

export function look_at_all() { Object.assign(view, {zoom: 1, x: 0, y: 0}); resize(); }
export function zoom(by, at = null) {
  const before = at && to_mm(...at), zoomed = clamp(view.zoom * by, 0.5, 12);
  view.zoom = zoomed;
  place();
  if (before) { const now = to_px(before); view.x += at[0] - now[0]; view.y += at[1] - now[1]; place(); }
  outdated("ground", "ink");
}
// Keeps two places of the array under two fingers that move from a and b to c and d, in pixels.
export function zoom_by_two([a, b], [c, d]) {
  const apart = (p, q) => Math.max(20, distance(p, q)), middle = (p, q) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
  const from = middle(a, b), to = middle(c, d);
  pan(to[0] - from[0], to[1] - from[1]);
  zoom(apart(c, d) / apart(a, b), to);
}
export function pan(dx, dy) { view.x += dx; view.y += dy; place(); outdated("ground", "ink"); }

// Returns the margins of the stage that tools, title and an open sheet cover.
function insets() {
  const s = getComputedStyle(canvas), v = name => parseFloat(s.getPropertyValue(name)) || 0;
  Object.assign(view, {scale_bottom: v("--scale-bottom") || 20, scale_left: v("--scale-left") || 18});
  const free = {left: v("--free-left"), right: v("--free-right"), top: v("--free-top"), bottom: v("--free-bottom")};
  const stage = by_id("stage").getBoundingClientRect(), hint = by_id("hint").getBoundingClientRect(), gallery = by_id("p-gallery");
  const sheet = (gallery.matches(":popover-open") ? gallery : by_id(state.placing ? "place-bar" : "sheet-head")).getBoundingClientRect();
  if (hint.width) { free.bottom = Math.max(free.bottom, stage.bottom - hint.top + 8); view.scale_bottom = -99; } // the words lie on the scale
  if (!sheet.width || sheet.left >= stage.right) return free;
  if (sheet.left > stage.left + 10) return {...free, right: stage.right - sheet.left + 10};
  return {...free, top: 12, bottom: stage.bottom - sheet.top + 8};
}
function place() {
  if (!array || !view.width) return;
  const i = insets(), margin = 2 * (array.radius + array.pitch * 0.1);
  const width = Math.max(60, view.width - i.left - i.right), height = Math.max(60, view.height - i.top - i.bottom);
  const shown = state.placing ? box(body_corners(array.box.middle)) : array.box;
  const fit = Math.min(width / (shown.size[0] + margin), height / (shown.size[1] + margin + array.pitch * 0.12));
  view.scale = fit * view.zoom;
  view.left = i.left + width / 2 + (array.box.middle[0] - shown.middle[0]) * view.scale + view.x;
  view.top = i.top + height / 2 + (array.box.middle[1] - shown.middle[1] - array.pitch * 0.03) * view.scale + view.y;
}
export function resize() {
  if (state.drawing) return; // the canvas never moves under a finger
  const r = by_id("stage").getBoundingClientRect();
  view.dpr = Math.min(3, devicePixelRatio || 1);
  view.width = r.width; view.height = r.height;
  for (const c of Object.values(layers)) {
    c.width = Math.round(r.width * view.dpr);
    c.height = Math.round(r.height * view.dpr);
    // A fixed size prevents stretching if the screen changes under a finger.
    Object.assign(c.style, {width: `${r.width}px`, height: `${r.height}px`});
  }
  place();
  outdated("ground", "ink");
}
function is_outgrown() {
  const r = by_id("stage").getBoundingClientRect();
  return r.width !== view.width || r.height !== view.height;
}
export function outdated(...names) { names.forEach(l => { stale[l] = true; }); changed("frame"); }
on_change(() => outdated("ink"), "take", "plan", "drawing", "tool", "knot");
on_change(() => outdated("ground", "ink"), "theme", "array");
on_change(what => { if (what.has("layout") || is_outgrown()) resize(); }, "layout", "drawing");

// Clears a layer for drawing.
export function start_layer(c) {
  const p = c.getContext("2d");
  p.setTransform(view.dpr, 0, 0, view.dpr, 0, 0);
  p.clearRect(0, 0, view.width, view.height);
  p.lineJoin = p.lineCap = "round";
  return p;
}
export function trace(p, places, closed = false) {
  p.beginPath();
  for (const q of places) p.lineTo(...to_px(q));
  if (closed) p.closePath();
}
export const trace_rows = (p, rows) => trace(p, rows.map(q => [q[1], q[2]]));
