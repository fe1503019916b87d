// SPDX-License-Identifier: MIT
// The switch at the bottom of the canvas: the stroke plays as drawn, or as the curve through its points.
import {state, on_change, current_stroke} from "../state.js";
import {by_id, on_click, show_pressed, listen, set_text} from "../../../net/page/dom.js";
import {edit_stroke} from "./takes.js";
import {shape, as_drawn, as_edited, points_moved, fitted_within, FIT_MM} from "./stroke.js";

function curve_text(s, edited, points) {
  const n = edited ? points_moved(edited) : s.knots?.length, within = `within ${s.fit_mm ?? FIT_MM} mm`;
  if (edited) return n ? `Edited, ${n} ${n === 1 ? "point" : "points"}` : "Edited";
  return points && s.fit_mm ? `${n} points, ${within}` : `Fitted, ${within}`;
}
function show_shape() {
  const s = current_stroke(), now = shape(s), edited = now === "edited" ? s : s?.edited;
  const points = s && state.tool === "points", slider = by_id("fit-mm");
  by_id("shape").hidden = state.drawing !== null || !(points || edited || now === "fitted");
  if (by_id("shape").hidden) return;
  for (const id of ["shape-ink", "shape-curve"]) by_id(id).hidden = now === null;
  slider.hidden = !points;
  slider.value = s.fit_mm ?? FIT_MM;
  slider.style.setProperty("--part", `${100 * (slider.value - slider.min) / (slider.max - slider.min)}%`);
  show_pressed(by_id("shape-ink"), now === "drawn");
  show_pressed(by_id("shape-curve"), now !== "drawn");
  set_text("shape-curve", curve_text(s, edited, points));
}
on_click("shape-ink", () => { if (shape(current_stroke()) !== "drawn") edit_stroke(as_drawn); });
on_click("shape-curve", () => { if (shape(current_stroke()) === "drawn") edit_stroke(as_edited); });
listen("fit-mm", "input", e => edit_stroke(s => fitted_within(s, +e.target.value), "fit"));
on_change(show_shape, "take", "drawing", "tool");
