// SPDX-License-Identifier: MIT
// The body with the array, to scale, on which a participant shows a place or draws a path. Coordinates are those of the array, mm.
import {make} from "../../../net/page/dom.js";
import {PARTS, find_body, body_matrix} from "../../../net/page/body_parts.js";

const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const LEAST_HALF_MM = 55, EDGE_MM = 25; // half of the field at least, and around the array: people also feel touches beside the tactors
const RING_MM = 3, MARK_MM = 1.6;       // radius
const LEAST_MM = 0.5, LEAST_MS = 30; // between two points of a path

// Returns a square.
function find_box(tactors) {
  const ends = [0, 1].map(k => tactors.map(t => t[k])).map(all => [Math.min(...all), Math.max(...all)]);
  const middle = ends.map(([from, to]) => (from + to) / 2);
  const half = Math.max(LEAST_HALF_MM, ...ends.map(([from, to]) => (to - from) / 2 + EDGE_MM));
  return {middle, view: [middle[0] - half, middle[1] - half, 2 * half, 2 * half]};
}
// Draws the part of the body under the array, if its outline is known.
function draw_body(facts, middle) {
  const body = find_body(facts), {outline, lines} = PARTS[body.part], {a, b, c, d, e, f} = body_matrix(body, middle, 1);
  return outline && make("g", {transform: `matrix(${[a, b, c, d, e, f]})`},
    make("path", {d: outline, class: "outline"}), make("path", {d: lines, class: "lines"}));
}
// Returns the moves since the last frame, which a browser may report together.
function list_moves(e) {
  const all = e.getCoalescedEvents?.() ?? [];
  return all.length ? all : [e];
}
// Keeps every second point, and the last.
const thin_out = points => points.filter((_, i) => i % 2 === 0 || i === points.length - 1);

// Returns the field and a button that answers with points [time in s, x, y]. `entry`: what is drawn, and the most points.
export function make_drawing({draw, most}, facts, words, answer) {
  const box = find_box(facts.tactors), is_place = draw === "place";
  let points = [], began_ms = 0, last_ms = 0, finger = null;
  const line = make("polyline", {class: "drawn"}), mark = make("circle", {class: "mark", r: MARK_MM});
  const confirm = make("button", {type: "button", onclick: () => answer(points)}, words.confirm);
  const field = make("svg", {viewBox: box.view.join(" "), id: "hand", role: "application", tabindex: 0, "aria-labelledby": "question"},
    draw_body(facts, box.middle), ...facts.tactors.map(([cx, cy]) => make("circle", {cx, cy, r: RING_MM, class: "ring"})), line, mark);
  const show = () => {
    const [, cx, cy] = points.at(-1) ?? [];
    line.setAttribute("points", points.map(([, x, y]) => `${x} ${y}`).join(" "));
    mark.setAttribute("cx", cx ?? 0);
    mark.setAttribute("cy", cy ?? 0);
    const fits = is_place ? points.length === 1 : points.length > 1 && finger === null;
    field.parentElement?.classList.toggle("unset", !points.length);
    confirm.disabled = field.classList.contains("closed") || !fits;
  };
  const to_mm = e => {
    const {x, y} = new DOMPoint(e.clientX, e.clientY).matrixTransform(field.getScreenCTM().inverse());
    return [x, y].map(v => Math.round(v * 100) / 100);
  };
  const add = (e, now_ms) => {
    const [x, y] = to_mm(e), [, before_x, before_y] = points.at(-1) ?? [];
    if (points.length && Math.hypot(x - before_x, y - before_y) < LEAST_MM && now_ms - last_ms < LEAST_MS) return;
    last_ms = now_ms;
    points.push([Math.round(now_ms - began_ms) / 1000, x, y]);
    if (points.length > most) points = thin_out(points);
  };
  field.onpointerdown = e => {
    if (finger !== null || !e.isPrimary || e.button > 0 || field.classList.contains("closed")) return;
    e.preventDefault(); // no selection, no scrolling
    field.focus({preventScroll: true});
    field.setPointerCapture(e.pointerId);
    [points, finger, began_ms] = [[], e.pointerId, e.timeStamp];
    add(e, e.timeStamp);
    show();
  };
  field.onpointermove = e => {
    if (e.pointerId !== finger) return;
    if (is_place) points = [[0, ...to_mm(e)]];
    else for (const one of list_moves(e)) add(one, Math.max(last_ms, one.timeStamp));
    show();
  };
  const end = e => {
    if (e.pointerId !== finger) return;
    finger = null;
    show();
  };
  field.onpointerup = end;
  field.onpointercancel = end;
  field.onkeydown = e => {
    if (e.key === "Enter" && !e.repeat) confirm.click();
    if (!is_place || !(e.key in ARROWS) || field.classList.contains("closed")) return;
    e.preventDefault();
    const [, x, y] = points.at(-1) ?? [0, ...box.middle], step = e.shiftKey ? 5 : 1;
    points = [[0, x + step * ARROWS[e.key][0], y + step * ARROWS[e.key][1]]];
    show();
  };
  return [field, confirm];
}
