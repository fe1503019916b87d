// SPDX-License-Identifier: MIT
// The strokes in time: buttons under the lanes' canvas, which handles pointers and draws marks over them.
import {state, changed, current_take, say} from "../state.js";
import {by_id, make, show_pressed} from "../../../net/page/dom.js";
import {put_stroke, edit_take, end_edit} from "../takes/takes.js";
import {duration_s, total_s} from "../takes/stroke.js";
import {PAUSE_S} from "../drawing/pointer.js";
import {seconds_text} from "../words.js";
import {clip_box, to_x, total, CLIP, MOST_S} from "./time_axis.js";

const MOVE_S = 0.1, FINE_MOVE_S = 0.01;
const MOST_STROKES = 32; // with it, two rounds of a loop are within the service's limit
const clips_box = by_id("clips");

export function choose_clip(i) {
  if (i !== state.stroke) Object.assign(state, {stroke: i, knot: -1});
  changed("take");
}
export const starting_at = (s, t) => ({...s, start_s: +Math.min(MOST_S - duration_s(s), Math.max(0, t)).toFixed(3)});
// Returns the strokes of a take and consecutive copies of stroke i from a moment on.
export function with_copies({name: take_name, strokes}, i, count, from_s = total_s(strokes) + PAUSE_S) {
  // A single stroke is shown by the name of its take.
  const step_s = duration_s(strokes[i]) + PAUSE_S, name = strokes[1] ? strokes[i].name : take_name, out = [...strokes];
  out[i] = {...strokes[i], name};
  for (; count >= 1 && out.length < MOST_STROKES && from_s + step_s < MOST_S; --count, from_s += step_s)
    out.push(starting_at({...out[i], name: `${name.replace(/ \d+$/, "")} ${out.length + 1}`}, from_s));
  return out;
}
// Copies the edited stroke, and edits the copy.
export function copy_clip(from_s, same) {
  const take = current_take();
  if (!take?.strokes.length) return;
  edit_take(() => ({strokes: with_copies(take, state.stroke, 1, from_s)}), same);
  choose_clip(current_take().strokes.length - 1);
  return state.stroke;
}
export function toggle_append() {
  state.append = !state.append;
  say(state.append ? "The next drawing follows the last stroke" : "Each drawing is a new take");
  changed("curves");
}
const clip_button = i => make("button", {onclick: () => choose_clip(i), onblur: end_edit, onkeydown: e => {
  const step = {ArrowLeft: -1, ArrowRight: 1}[e.key];
  if (!step) return;
  e.preventDefault();
  put_stroke(s => starting_at(s, s.start_s + step * (e.shiftKey ? FINE_MOVE_S : MOVE_S)), `clip key ${i}`, i);
}});
const add_button = make("button", {onclick: toggle_append, "aria-label": "Add the next drawing to this take"}, "+");
clips_box.append(add_button);

export function place_clips(l) {
  const take = current_take(), strokes = state.drawing ? [] : take?.strokes ?? [];
  clips_box.hidden = !strokes.length;
  while (clips_box.childElementCount - 1 > strokes.length) clips_box.firstChild.remove();
  while (clips_box.childElementCount - 1 < strokes.length) add_button.before(clip_button(clips_box.childElementCount - 1));
  const put = (b, x, width) => Object.assign(b.style, {left: `${x}px`, top: `${l.ruler}px`, width: `${width}px`, height: `${CLIP - 4}px`});
  strokes.forEach((s, i) => {
    const [a, b] = clip_box(l, s), button = clips_box.children[i], name = strokes[1] ? s.name : take.name;
    put(button, a, Math.max(6, b - a));
    button.textContent = name;
    button.setAttribute("aria-label", `${name}, starts at ${seconds_text(s.start_s)}, lasts ${seconds_text(duration_s(s))}; arrows move it`);
    show_pressed(button, i === state.stroke);
  });
  put(add_button, to_x(l, total()) + 8, 28);
  show_pressed(add_button, state.append);
}
