// SPDX-License-Identifier: MIT
// The body: outlines of its parts, and the place of the array on it, from its file or as chosen in this browser.
import {state, changed, on_change, remember, remembered} from "../state.js";
import * as parts from "../../../net/page/body_parts.js";
import {PARTS, usual_place} from "../../../net/page/body_parts.js";

// Place of the body: the array's middle is x, y mm from the landmark, seen by a viewer. The body is turned under it, in degrees clockwise.
export const body = usual_place("palm");
let place_key = "", in_file = ""; // place in the file, if it has a site
export const part = () => PARTS[body.part];
export const outline_mm = () => parts.outline_mm(body);
export const is_in_file = () => JSON.stringify(body) === in_file;
export function set_body(values) {
  remember(place_key, JSON.stringify([in_file, Object.assign(body, values)]));
  changed("body");
}
export const up_word = () => parts.directions(body)[(Math.round(body.turn / 90) + 4) % 4] ?? state.hello.array.up ?? ""; // direction that is up on the screen
export const place_name = () => part().lines ? (part().sides ? body.right ? "right " : "left " : "") + body.part : state.hello.array.site;
// Returns the matrix that puts the outline under a place, at a scale.
export const body_matrix = (middle, scale) => parts.body_matrix(body, middle, scale);
// Returns the corners of the part, mm, around the middle of an array.
export const body_corners = (middle, [x, y, w, h] = part().box, m = body_matrix(middle, 1)) =>
  [x, x + w].flatMap(u => [y, y + h].map(v => m.transformPoint({x: u, y: v}))).map(q => [q.x, q.y]);
on_change(() => {
  const a = state.hello?.array;
  if (!a) return;
  Object.assign(body, parts.find_body(a));
  [in_file, place_key] = [a.site ? JSON.stringify(body) : "", `body-${a.name}-${a.tactors.length}`];
  const [file, kept] = JSON.parse(remembered(place_key)) ?? [];
  if (file === in_file) Object.assign(body, kept);
}, "array");
