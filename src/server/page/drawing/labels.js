// Places of the labels on the canvas: a label never lies on another, on a disc or on a stroke. Without a free place it is left out.
import {state} from "../state.js";
import {colour, font} from "../look.js";
import {array, view, to_px} from "./view.js";
import {clamp, distance} from "../geometry.js";

const HIGH_PX = 15, SHARE_PX = 40; // "100 %"
const FAR_PX = [9, 20, 34];
const ANGLES = 16;
const POINTS = 200; // number of a stroke's points that labels avoid

let circles = [], boxes = [], share_places = [], number_places = [];

const labels_touch = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
const circle_touches = ([x, y, r], b) => Math.hypot(x - clamp(x, b[0], b[2]), y - clamp(y, b[1], b[3])) < r;
function is_free(b) {
  return b[0] > 2 && b[1] > 2 && b[2] < view.width - 2 && b[3] < view.height - 2
    && !boxes.some(o => labels_touch(o, b)) && !circles.some(c => circle_touches(c, b));
}
// Takes the first free place and returns its middle, or null.
function take_place(w, places) {
  for (const [x, y] of places) {
    const b = [x - w / 2, y - HIGH_PX / 2, x + w / 2, y + HIGH_PX / 2];
    if (is_free(b)) { boxes.push(b); return [x, y]; }
  }
  return null;
}
function* places_round([x, y], w, first) {
  for (const far of FAR_PX) for (let k = 0; k < ANGLES; ++k) {
    const angle = first + (k % 2 ? 1 : -1) * Math.ceil(k / 2) * 2 * Math.PI / ANGLES, c = Math.cos(angle), s = Math.sin(angle);
    yield [x + c * (far + w / 2), y + s * (far + HIGH_PX / 2)];
  }
}
// Finds places for each tactor's number, where no stroke or mark hides it, and for its part of amplitude. `marks`: px.
export function place_labels(strokes, marks = []) {
  const r = array.radius * view.scale, centres = array.places.map(to_px);
  circles = [...centres.map(c => [...c, r + 2]), ...state.outside.map(w => [...to_px(w.place), 13])];
  boxes = [];
  if (array.up) { const [x, y] = to_px([array.box.middle[0], array.box.least[1] - array.radius]); boxes.push([x - 50, y - 21, x + 50, y - 2]); }
  const away = HIGH_PX / 2 + r + 3, beside = r + SHARE_PX / 2 + 4;
  share_places = centres.map(([x, y]) => take_place(SHARE_PX, [[x, y + away], [x, y - away], [x + beside, y], [x - beside, y]]));
  const path = strokes.flatMap(s => {
    const step = Math.max(1, Math.floor(s.timed.length / POINTS));
    return s.timed.filter((_, i) => i % step === 0).map(q => [...to_px(q.slice(1)), 6]);
  });
  const marked = [...path, ...marks.map(q => [...q, 9])], reach_px = i => 4 + 3 * String(i).length;
  const off = r > 16 ? r * 0.6 : 0, hidden = (at, i) => marked.some(q => distance(q, at) < q[2] + reach_px(i));
  number_places = centres.map(([x, y], i) => [[x, y], [x, y - off], [x, y + off], [x - off, y], [x + off, y]].find(q => !hidden(q, i)) ?? [x, y]);
  circles.push(...path);
}
export const number_place = i => number_places[i];
// Draws the names of the ends of a stroke, if there is a place.
export function draw_labels(p, {timed: rows}) {
  p.font = font(12, 600);
  p.textAlign = "center";
  const first = to_px(rows[0].slice(1)), last = to_px(rows.at(-1).slice(1));
  draw_end(p, "start", first, to_px(rows[Math.min(rows.length - 1, 3)].slice(1)));
  if (distance(first, last) > 24) draw_end(p, "end", last, to_px(rows[Math.max(0, rows.length - 4)].slice(1)));
}
function draw_end(p, text, at, next) {
  const place = take_place(p.measureText(text).width + 4, places_round(at, p.measureText(text).width, Math.atan2(at[1] - next[1], at[0] - next[0])));
  if (place) draw_label(p, text, place, "ink");
}
function draw_label(p, text, [x, y], tone) {
  p.lineWidth = 4;
  p.strokeStyle = colour("skin");
  p.strokeText(text, x, y + 4);
  p.fillStyle = colour(tone);
  p.fillText(text, x, y + 4);
}
// Writes a part of full amplitude next to its tactor.
export function draw_share(p, i, share) {
  if (!share_places[i]) return;
  p.font = font(12, 600);
  p.textAlign = "center";
  draw_label(p, `${Math.round(share * 100)} %`, share_places[i], "felt-ink");
}
// Returns the boxes of all labels, px.
export const label_boxes = () => boxes;
