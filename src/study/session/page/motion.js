// SPDX-License-Identifier: MIT
// Draws the array and a motion over it, to scale in millimetres.
import {by_id, make} from "../../../net/page/dom.js";
import {viridis} from "../../../net/page/viridis.js";

const SEGMENTS = 30; // number of line segments in a picture

function find_pitch(tactors) {
  const apart = tactors.flatMap((a, i) => tactors.slice(i + 1).map(b => Math.hypot(a[0] - b[0], a[1] - b[1])));
  return Math.min(...apart, 40);
}
function frame(points, edge) {
  const [xs, ys] = [0, 1].map(k => points.map(p => p[k]));
  const [x, y] = [Math.min(...xs) - edge, Math.min(...ys) - edge];
  return [x, y, Math.max(...xs) + edge - x, Math.max(...ys) + edge - y];
}
function place_at(path, part) {
  const at = Math.min(1, Math.max(0, part)) * (path.length - 1), i = Math.min(path.length - 2, Math.floor(at));
  return [0, 1].map(k => path[i][k] + (at - i) * (path[i + 1][k] - path[i][k]));
}

export function draw_target(tactors, path) {
  const pitch = find_pitch(tactors), field = by_id("field");
  const box = frame([...tactors, ...path], pitch * .7);
  field.setAttribute("viewBox", box.join(" "));
  field.style.setProperty("--ratio", box[2] / box[3]);
  field.replaceChildren(...tactors.map(([cx, cy]) => make("circle", {cx, cy, r: pitch * .28, class: "ring"})),
    make("circle", {id: "dot", r: pitch * .15, "stroke-width": pitch * .16}));
  move_target(path, 0);
}
export function move_target(path, part) {
  const [x, y] = place_at(path, part);
  by_id("dot").setAttribute("cx", x);
  by_id("dot").setAttribute("cy", y);
}

// Draws a motion from a ring at its start to an arrow at its end. The colours show time.
export function draw_picture(tactors, path) {
  const box = frame([...tactors, ...path], find_pitch(tactors) * .45), size = Math.max(box[2], box[3]);
  const places = Array.from({length: SEGMENTS + 1}, (_, i) => place_at(path, i / SEGMENTS));
  const end = places[SEGMENTS], before = place_at(path, 1 - 1.5 / SEGMENTS);
  const angle = Math.atan2(end[1] - before[1], end[0] - before[0]) * 180 / Math.PI;
  const picture = make("svg", {viewBox: box.join(" "), class: "picture", "aria-hidden": "true"},
    ...tactors.map(([cx, cy]) => make("circle", {cx, cy, r: size * .026, class: "place"})),
    make("polyline", {points: places.join(" "), class: "edge", "stroke-width": size * .062}));
  for (let i = 0; i < SEGMENTS; ++i) {
    const part = make("polyline", {points: [places[i], places[i + 1]].join(" "), class: "time", "stroke-width": size * .045});
    part.style.setProperty("--light", viridis(i / (SEGMENTS - 1), false));
    part.style.setProperty("--dark", viridis(i / (SEGMENTS - 1), true));
    picture.append(part);
  }
  picture.append(make("circle", {cx: places[0][0], cy: places[0][1], r: size * .045, class: "start", "stroke-width": size * .022}),
    make("path", {d: "M.9 0L-.7 .85L-.35 0L-.7 -.85Z", class: "end",
      transform: `translate(${end.join(" ")}) rotate(${angle}) scale(${size * .085})`}));
  return picture;
}
