// SPDX-License-Identifier: MIT
// Keys, wherever the focus is.
import {state, changed} from "../state.js";
import {by_id, make, show_pressed, all_of} from "../../../net/page/dom.js";
import {play, stop} from "../service/player.js";
import {undo, redo, choose_take} from "../takes/takes.js";
import {zoom} from "../drawing/view.js";
import {show_all_time, zoom_time, clear_marks} from "../time/time_axis.js";
import {step_burst} from "../time/lanes.js";
import {copy_clip} from "../time/clips.js";
import {remove_point} from "../drawing/pointer.js";
import {show_place} from "../drawing/place.js";
import {toggle_compare, close_compare, choose_side} from "./compare.js";

const KEYS = [["Space, X, Esc", "stop everybody's strokes"], ["P, Shift P", "play, play from this moment"], ["L", "loop"], ["F", "Feel on or off"],
  ["D, S, E, W", "Draw, Line, Points, Felt"], ["N", "new take"], ["G", "gallery"], ["B, 1, 2", "compare two methods, play the first, the second"],
  ["Ctrl Z, Ctrl Shift Z", "undo, redo"], ["H, arrows", "place on the body, move it"], ["0, +, −, Ctrl wheel", "array: show all, larger, smaller, zoom"],
  ["T", "timeline: open, close"], ["Z, ], [, Ctrl wheel", "show all of it, less, more, zoom"], [", .", "one burst back, on"], ["J, Alt", "scrub felt or silent, no snapping"],
  ["Enter, Shift Enter", "start here, range until here"], ["Shift Home", "clear both"], ["Ctrl D", "copy the stroke"],
  ["Enter, arrows", "array: begin or end a touch, move it"], ["Tab, arrows, Enter", "Points and Felt: next point, move it (Shift: less), curve or corner"],
  ["Delete", "delete the point"], ["Space, Esc", "in silence: press the button, close what is open"]];
by_id("keys").replaceChildren(...KEYS.flatMap(([k, what]) => [make("dt", {}, k), make("dd", {}, what)]));

const is_field = e => e instanceof HTMLInputElement && ["text", "password"].includes(e.type);
const is_number = e => is_field(e) && e.inputMode === "decimal"; // a number has no blank, so Space stops there, too
const is_text = e => is_field(e) && !is_number(e);
const press = id => () => by_id(id).click();
export function new_take() {
  state.append = false;
  choose_take(null);
}
const ACTIONS = {
  p: e => play(e.shiftKey ? {from_s: state.at_s} : undefined), l: press("loop"), d: () => choose_tool("draw"), s: () => choose_tool("line"), e: () => choose_tool("points"),
    w: () => choose_tool("felt"), b: toggle_compare, 1: () => choose_side(0), 2: () => choose_side(1), f: press("feel"), j: press("scrub"), n: new_take, g: press("gallery-open"), x: () => stop(),
  0: press("show-all"), "+": () => zoom(1.3), "=": () => zoom(1.3), "-": () => zoom(1 / 1.3),
  h: () => { open_sheet(""); show_place(); }, t: () => fold_time(), "[": () => zoom_time(1.5), "]": () => zoom_time(1 / 1.5), z: show_all_time,
  ",": () => step_burst(-1), ".": () => step_burst(1),
};
const STEPS = new Set([",", ".", "+", "=", "-", "[", "]"]);
// Closes an open sheet or popover; stops if none is open.
function leave(e) {
  const open = document.querySelector(":popover-open");
  if (open) return open.hidePopover();
  if (document.body.dataset.sheetOpen) return open_sheet("");
  if (state.placing) return show_place(false);
  if (state.compare) return close_compare();
  if (!e.repeat) stop();
}
// Opens a sheet of a small window, or the dock of a medium one.
export function open_sheet(name) {
  if (state.drawing) return; // the canvas never changes under a finger
  if (name) state.sheet = name;
  if (name) document.body.dataset.sheetOpen = name; else delete document.body.dataset.sheetOpen;
  for (const b of all_of("button[data-sheet]")) show_pressed(b, b.dataset.sheet === (name || "inspector"));
  by_id("settings").setAttribute("aria-expanded", name !== "");
  changed("layout");
}
// Folds or unfolds the timeline: a sheet, or the strip of a low window.
export function fold_time() {
  const body = document.body.dataset;
  if (by_id("settings").checkVisibility()) return open_sheet(body.sheetOpen === "time" ? "" : "time");
  if (state.drawing) return;
  by_id("time-fold").setAttribute("aria-expanded", document.body.toggleAttribute("data-time-open"));
  changed("layout");
}
export function choose_tool(tool) {
  Object.assign(state, {tool, knot: -1});
  changed("tool");
}
// Space stops, before any control gets it. If nothing can sound, it presses the button with the focus.
const may_sound = () => state.playing || state.stopping || state.drawing || state.speaker && state.tapped >= 0 || state.link !== "connected" || state.slow
  || state.dbfs.some(v => v !== null) || state.status?.strokes.some(k => k.state === "started");
let stops = false;
for (const event of ["keydown", "keyup"]) addEventListener(event, e => {
  if (e.code !== "Space" && e.key !== " " || is_text(e.target)) return;
  if (event === "keydown" && !e.repeat) stops = may_sound() || !e.target.closest?.("button, summary");
  if (!stops) return;
  e.preventDefault();
  e.stopImmediatePropagation();
  if (event === "keydown" && !e.repeat) stop();
}, {capture: true});
addEventListener("keydown", e => {
  if (is_field(e.target) && !(is_number(e.target) && e.key === "Escape")) return; // keys type, and undo typing, in a field
  if (e.ctrlKey || e.metaKey) {
    const edit = {z: e.shiftKey ? redo : undo, y: redo, d: () => copy_clip()}[e.key.toLowerCase()];
    if (edit) e.preventDefault();
    return edit?.();
  }
  if (e.altKey) return;
  if (e.shiftKey && e.key === "Home") return clear_marks();
  if (["Delete", "Backspace"].includes(e.key) && state.tool === "points" && state.knot >= 0) {
    e.preventDefault();
    return remove_point();
  }
  if (e.key === "Escape") return leave(e);
  const f = ACTIONS[e.key.toLowerCase()];
  if (!f) return;
  e.preventDefault();
  if (!e.repeat || STEPS.has(e.key)) f(e); // a held key acts only once
});
