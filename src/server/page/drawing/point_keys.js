// SPDX-License-Identifier: MIT
// Points by keys, while the tool is Points or Felt and the canvas has the focus: Tab walks them, arrows move the chosen one, Enter makes it
// a curve or a corner. Tab after the last one leaves the canvas.
import {state, changed, current_stroke} from "../state.js";
import {listen} from "../../../net/page/dom.js";
import {edit_stroke} from "../takes/takes.js";
import {editable, changed_knot} from "../takes/stroke.js";
import {change_point} from "./pointer.js";
import {step_felt} from "./felt.js";

const MOVE_MM = 0.5, FINE_MOVE_MM = 0.1;
export const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

function act(e) {
  const felt = state.tool === "felt";
  if ((state.tool !== "points" && !felt) || state.placing || !current_stroke() || e.ctrlKey || e.metaKey || e.altKey) return false;
  const knots = editable(current_stroke()).knots, at = state.knot, k = knots[at], step = ARROWS[e.key];
  if (e.key === "Tab") {
    const next = at < 0 && e.shiftKey ? knots.length - 1 : at + (e.shiftKey ? -1 : 1);
    state.knot = knots[next] ? next : -1;
    changed("knot");
    return state.knot >= 0;
  }
  if (!k || (!step && (felt || e.key !== "Enter"))) return false;
  const mm = e.shiftKey ? FINE_MOVE_MM : MOVE_MM;
  if (!step) change_point({corner: !k.corner});
  else if (felt) step_felt(at, step.map(v => v * mm));
  else edit_stroke(s => changed_knot(s, at, {x: +(k.x + step[0] * mm).toFixed(3), y: +(k.y + step[1] * mm).toFixed(3)}), `key knot ${at}`);
  return true;
}
listen("field", "keydown", e => {
  if (act(e)) { e.preventDefault(); e.stopImmediatePropagation(); }
}, {capture: true});
