// SPDX-License-Identifier: MIT
// Draws the array and a motion over it, to scale in millimetres. A motion has a path for each of its strokes.
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
// Returns nothing where the stroke is not felt.
function place_at(path, part) {
  const at = Math.min(1, Math.max(0, part)) * (path.length - 1), i = Math.min(path.length - 2, Math.floor(at));
  const from = path[i], to = path[i + 1];
  return from && to ? [0, 1].map(k => from[k] + (at - i) * (to[k] - from[k])) : null;
}

export function draw_target(tactors, paths) {
  const pitch = find_pitch(tactors), field = by_id("field");
  const box = frame([...tactors, ...paths.flat().filter(p => p)], pitch * .7);
  field.setAttribute("viewBox", box.join(" "));
  field.style.setProperty("--ratio", box[2] / box[3]);
  field.replaceChildren(...tactors.map(([cx, cy]) => make("circle", {cx, cy, r: pitch * .28, class: "ring"})),
    ...paths.map(() => make("circle", {class: "dot", r: pitch * .15, "stroke-width": pitch * .16})));
  move_target(paths, 0);
}
export function move_target(paths, part) {
  by_id("field").querySelectorAll(".dot").forEach((dot, i) => {
    const place = place_at(paths[i], part);
    dot.classList.toggle("away", !place);
    if (!place) return;
    dot.setAttribute("cx", place[0]);
    dot.setAttribute("cy", place[1]);
  });
}

// Draws each stroke of a motion from a ring at its start to an arrow at its end. The colours show time.
export function draw_picture(tactors, paths) {
  const box = frame([...tactors, ...paths.flat()], find_pitch(tactors) * .45), size = Math.max(box[2], box[3]);
  const picture = make("svg", {viewBox: box.join(" "), class: "picture", "aria-hidden": "true"},
    ...tactors.map(([cx, cy]) => make("circle", {cx, cy, r: size * .026, class: "place"})));
  for (const path of paths) picture.append(...draw_stroke(path, size));
  return picture;
}
function draw_stroke(path, size) {
  const places = Array.from({length: SEGMENTS + 1}, (_, i) => place_at(path, i / SEGMENTS));
  const end = places[SEGMENTS], before = place_at(path, 1 - 1.5 / SEGMENTS);
  const angle = Math.atan2(end[1] - before[1], end[0] - before[0]) * 180 / Math.PI;
  const parts = [make("polyline", {points: places.join(" "), class: "edge", "stroke-width": size * .062})];
  for (let i = 0; i < SEGMENTS; ++i) {
    const part = make("polyline", {points: [places[i], places[i + 1]].join(" "), class: "time", "stroke-width": size * .045});
    part.style.setProperty("--light", viridis(i / (SEGMENTS - 1), false));
    part.style.setProperty("--dark", viridis(i / (SEGMENTS - 1), true));
    parts.push(part);
  }
  parts.push(make("circle", {cx: places[0][0], cy: places[0][1], r: size * .045, class: "start", "stroke-width": size * .022}),
    make("path", {d: "M.9 0L-.7 .85L-.35 0L-.7 -.85Z", class: "end",
      transform: `translate(${end.join(" ")}) rotate(${angle}) scale(${size * .085})`}));
  return parts;
}
