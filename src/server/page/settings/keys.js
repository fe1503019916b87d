// SPDX-License-Identifier: MIT
// Keys, wherever the focus is.
import {state, changed} from "../state.js";
import {by_id, make} from "../../../net/page/dom.js";
import {play, stop} from "../service/player.js";
import {undo, redo, choose_take} from "../takes/takes.js";
import {look_at_all} from "../drawing/view.js";
import {step_burst, show_all_time} from "../time/lanes.js";
import {remove_point} from "../drawing/pointer.js";

const KEYS = [["Space", "stop everything"], ["P", "play"], ["L", "loop"], ["D, S, E", "draw, straight line, edit points"],
  ["F", "feel on or off"], ["N", "new take"], ["0", "show all"],
  [", .", "one burst back, on"], ["Ctrl Z, Ctrl Shift Z", "undo, redo"], ["Delete", "delete the point"],
    ["Enter, arrows", "in the array: touch and lift, move"], ["Esc", "close; where nothing is open, stop"]];
by_id("keys").replaceChildren(...KEYS.flatMap(([k, what]) => [make("dt", {}, k), make("dd", {}, what)]));

const is_text = e => e instanceof HTMLInputElement && ["text", "password", "search"].includes(e.type)
  && e.inputMode !== "decimal" || e instanceof HTMLTextAreaElement || e?.isContentEditable;
const press = id => () => by_id(id).click();
export function new_take() {
  state.append = false;
  choose_take(null);
}
const ACTIONS = {
  p: () => play(), l: press("loop"), d: () => choose_tool("draw"), s: () => choose_tool("line"), e: () => choose_tool("points"),
    f: press("feel"), n: new_take,
  0: () => { look_at_all(); show_all_time(); }, ",": () => step_burst(-1), ".": () => step_burst(1),
};
const STEPS = new Set([",", "."]);
// Closes what is open; where nothing is, it stops.
function leave(e) {
  const open = document.querySelector(":popover-open");
  if (open) return open.hidePopover();
  if (!document.body.dataset.sheetOpen) { if (!e.repeat) stop(); return; }
  document.body.dataset.sheetOpen = "";
  changed("layout");
}
export function choose_tool(tool) {
  Object.assign(state, {tool, knot: -1});
  changed("tool");
}
// Space is taken before any control sees it: it stops.
addEventListener("keydown", e => {
  if (e.code === "Space" || e.key === " ") {
    if (is_text(e.target)) return;
    e.preventDefault();
    e.stopImmediatePropagation();
    if (!e.repeat) stop();
  }
}, {capture: true});
addEventListener("keyup", e => { if ((e.code === "Space" || e.key === " ") && !is_text(e.target)) { e.preventDefault();
  e.stopImmediatePropagation(); } }, {capture: true});
addEventListener("keydown", e => {
  if (is_text(e.target)) return;
  if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "z") { e.preventDefault(); if (e.shiftKey) redo(); else undo(); return;
    }
  if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "y") { e.preventDefault(); redo(); return; }
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  if ((e.key === "Delete" || e.key === "Backspace") && state.tool === "points" && state.knot >= 0) { e.preventDefault();
    remove_point(); return; }
  if (e.key === "Escape") return leave(e);
  const f = ACTIONS[e.key.toLowerCase()];
  if (!f) return;
  e.preventDefault();
  if (!e.repeat || STEPS.has(e.key)) f(); // a key that is held does one thing once
});
