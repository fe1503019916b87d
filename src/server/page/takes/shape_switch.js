// SPDX-License-Identifier: MIT
// The switch at the bottom of the canvas: the stroke plays as it was drawn, or the curve through its points.
import {state, on_change, current_stroke} from "../state.js";
import {by_id, on_click, show_pressed} from "../../../net/page/dom.js";
import {edit_stroke} from "./takes.js";
import {shape, as_drawn, as_edited, points_moved} from "./stroke.js";

function show_shape() {
  const s = current_stroke(), now = shape(s), edited = now === "edited" ? s : s?.edited, n = edited ? points_moved(edited) : 0;
  by_id("shape").hidden = now === null || state.drawing !== null;
  if (by_id("shape").hidden) return;
  show_pressed(by_id("shape-ink"), now === "drawn");
  show_pressed(by_id("shape-curve"), now !== "drawn");
  by_id("shape-curve").textContent = !edited ? "Fitted, within 0.2 mm" : !n ? "Edited" : `Edited, ${n} ${n === 1 ? "point" : "points"}`;
}
on_click("shape-ink", () => { if (shape(current_stroke()) !== "drawn") edit_stroke(as_drawn); });
on_click("shape-curve", () => { if (shape(current_stroke()) === "drawn") edit_stroke(as_edited); });
on_change(what => { if (what.has("take") || what.has("drawing")) show_shape(); });
