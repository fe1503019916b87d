// SPDX-License-Identifier: MIT
// Holds: actions that last while a pointer or a key holds an element, and end with it.
import {listen} from "../../../net/page/dom.js";
import {on_lost} from "./connection.js";

const HOLD_MS = 400; // a shorter touch is a tap

const holds = new Map(); // by pointer or key: {element, timer, begun, end}

// Begins a touch of an element. `begin()` is called once it is held, and returns what ends that; null where there is nothing to hold.
export function press(by, element, begin) {
  let_go(by);
  const own = {element, timer: setTimeout(() => {
    own.end = begin();
    own.begun = Boolean(own.end);
    element.toggleAttribute("data-held", own.begun);
  }, HOLD_MS)};
  holds.set(by, own);
}
function finish(own) {
  const {end} = own;
  own.end = null;
  clearTimeout(own.timer);
  own.element.removeAttribute("data-held");
  end?.();
}
// Ends a touch. Returns true if it was held, and false if it was a tap.
export function let_go(by) {
  const own = holds.get(by);
  if (!own) return false;
  holds.delete(by);
  finish(own);
  return own.begun;
}
const let_all_go = () => holds.forEach(finish);

// Lets a button act while it is held; a tap stays a click, and a key clicks when it is let go.
export function on_hold(button, begin) {
  let was_held = false; // by the press that is on, or was last
  const touch = by => {
    was_held = false;
    press(by, button, () => { const end = begin(); was_held = Boolean(end); return end; });
  };
  listen(button, "pointerdown", e => { if (e.button === 0) touch(e.pointerId); });
  listen(button, "keydown", e => {
    if (e.key !== "Enter" && e.key !== " ") return;
    e.preventDefault();
    if (!e.repeat) touch(e.key);
  });
  listen(button, "keyup", e => {
    if (e.key === " ") e.preventDefault();
    if (holds.has(e.key) && !let_go(e.key)) button.click();
  });
  listen(button, "blur", () => ["Enter", " "].forEach(let_go));
  // The click of a pointer; keys and assistive technology have no detail.
  listen(button, "click", e => { if (was_held && e.detail) e.stopImmediatePropagation(); }, {capture: true});
  listen(button, "contextmenu", e => { if (holds.size) e.preventDefault(); }); // of a finger that rests
}
for (const event of ["pointerup", "pointercancel"]) addEventListener(event, e => let_go(e.pointerId));
addEventListener("keydown", e => { if (e.key === "Escape") let_all_go(); }, {capture: true});
addEventListener("blur", let_all_go);
on_lost(let_all_go);
