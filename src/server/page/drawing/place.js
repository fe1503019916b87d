// SPDX-License-Identifier: MIT
// "Where is the array?": the locator, and the mode in which the body is moved and turned under the array.
import {state, on_change} from "../state.js";
import {by_id, make, on_click, listen} from "../../../net/page/dom.js";
import {plain_name} from "../words.js";
import {choice, button} from "../settings/controls.js";
import {array, view, to_px, handle_px, look_at_all, outdated, ARROWS} from "./view.js";
import {PARTS, mirror, usual_place} from "../../../net/page/body_parts.js";
import {body, part, outline_mm, is_in_file, set_body, up_word, place_name} from "./body.js";

const TURN_STEP = 15, REACH_OF_HANDLE_PX = 26;
const skin = by_id("field"), title = make("h2"), length = make("output"), angle = make("span"), lines = make("code", {id: "array-lines"});
const part_picture = (p, ...more) => make("svg", {class: "outline", viewBox: p.box.join(" ")},
  make("path", {d: p.outline, transform: `scale(${mirror(p, body.right)} 1)`}), ...more);
const set_and_fit = values => { set_body(values); look_at_all(); };
const turn_to = v => set_body({turn: 180 - (540 - Math.round(v)) % 360}); // -179 to 180
const tiles = choice({label: "Part of the body", shape: "parts", visible_label: false, get: () => body.part,
  set: name => { if (name !== body.part) set_and_fit(usual_place(name, body.right)); },
  values: Object.keys(PARTS).slice(1).map(value => ({value, update: b => b.replaceChildren(part_picture(PARTS[value]), plain_name(value),
    value === body.part && !is_in_file() ? make("small", {}, "not in the array’s file") : "")}))});
const sides = choice({label: "Side", visible_label: false, values: [{value: false, name: "Left"}, {value: true, name: "Right"}],
  get: () => body.right, set: right => { if (right !== body.right) set_and_fit({right, x: -body.x, turn: -body.turn}); }});
function change_length(by) {
  const usual = part().length, mm = +(body.length + by * (usual < 50 ? 0.1 : 1)).toFixed(1);
  if (mm > 0.83 * usual && mm < 1.223 * usual) set_body({length: mm}); // 150 to 220 for a hand
}
by_id("stage").append(make("div", {id: "place-bar"}, title, tiles.element, make("div", {class: "row"}, sides.element,
  button("", "minus", () => change_length(-1), {"aria-label": "Shorter"}), length,
  button("", "plus", () => change_length(1), {"aria-label": "Longer"}), button(angle, "loop", () => turn_to(body.turn + TURN_STEP)),
  make("span", {class: "space"}), make("details", {}, make("summary", {class: "button"}, "Array’s file"), lines),
  button("Done", "", () => show_place(false), {class: "button outlined"}))));
export function show_place(on = !state.placing) {
  if (!array || state.drawing) return;
  document.body.classList.toggle("placing", state.placing = on);
  set_and_fit({}); skin.focus();
}
on_click("locator", () => show_place(true));
on_change(() => {
  if (!array) return;
  // Draws the whole part, with the array's square on it.
  const {x, y, turn} = body, k = outline_mm(), [w, h] = array.box.size.map(v => (v + 2 * array.radius) / k), {from, measure: name} = part();
  by_id("locator").replaceChildren(part_picture(part(), make("rect", {x: -w / 2, y: -h / 2, width: w, height: h,
    transform: `translate(${x / k} ${y / k}) rotate(${-turn})`})));
  tiles.update(); sides.update(); sides.element.hidden = !part().sides;
  title.textContent = `Where is the array? ${from ? `${Math.abs(y)} mm from ${from}` : ""}`;
  length.textContent = `${name} ${body.length} mm`; angle.textContent = `turned ${turn}°`;
  const site = JSON.stringify(place_name()), up = up_word();
  lines.textContent = `[array]\nsite = ${site}\nup = "${up}"\nplace = [${x}, ${y}]\nturn = ${turn}\nbody = ${body.length}`;
  outdated("ground");
}, "body", "array");
// Pointers and keys on the canvas.
let grip = null;
const over_body = (x, y) => new DOMMatrix().rotate(-body.turn).transformPoint({x, y}); // converts a distance on the screen to one on the body
const move_from = ({x, y}, dx, dy, d = over_body(dx, dy)) => set_body({x: +(x - d.x).toFixed(1), y: +(y - d.y).toFixed(1)});
listen(skin, "pointerdown", e => {
  if (!state.placing || e.button > 0 || grip) return;
  const [x, y] = to_px(array.box.middle), q = over_body(e.offsetX - x, e.offsetY - y);
  grip = {id: e.pointerId, x: e.offsetX, y: e.offsetY, from: {...body}, turns: Math.hypot(q.x, q.y + handle_px()) < REACH_OF_HANDLE_PX};
});
listen(skin, "pointermove", e => {
  if (grip?.id !== e.pointerId) return;
  if (!grip.turns) return move_from(grip.from, (e.offsetX - grip.x) / view.scale, (e.offsetY - grip.y) / view.scale);
  const [x, y] = to_px(array.box.middle), step = e.altKey ? 1 : TURN_STEP;
  turn_to(Math.round(Math.atan2(e.offsetX - x, y - e.offsetY) * 180 / Math.PI / step) * step);
});
listen(skin, "lostpointercapture", () => { grip = null; });
listen(skin, "keydown", e => {
  const d = state.placing && ARROWS[e.key];
  if (d) { e.preventDefault(); move_from(body, ...d.map(v => e.shiftKey ? v / 10 : v)); }
});
