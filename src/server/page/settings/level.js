// SPDX-License-Identifier: MIT
// The level, and on the same scale the loudest tactor: both end at the owner's ceiling. What sounds follows.
import {state, changed, on_change, ceiling_dbfs} from "../state.js";
import {by_id, make, listen, set_text} from "../../../net/page/dom.js";
import {slider} from "./controls.js";
import {LEAST_LEVEL_DB} from "../service/planner.js";
import {number_text} from "../words.js";

const MOST_JUMP_DB = 3; // of a tap above the knob; to go further it is dragged

let tapped = false;
const level = slider({label: "Level", least: LEAST_LEVEL_DB, most: 0, step: 0.5, get: () => state.level_db, set: v => {
    state.level_db = tapped ? Math.min(v, state.level_db + MOST_JUMP_DB) : v;
    tapped = false;
    changed("level");
  },
  text: v => [`${Math.round(100 * 10 ** (v / 20))} %`, v === 0 ? "0 dB" : `${number_text(v)} dB`]});
listen(level.input, "pointerdown", () => { tapped = true; });
// The browser tells what a finger has tapped after it is up.
for (const end of ["click", "keydown"]) listen(level.input, end, () => { tapped = false; });
const bar = make("i"), meter = make("div", {class: "meter", "aria-hidden": "true"}, bar);
level.element.append(meter);
by_id("level").prepend(level.element);

let metered = "";
// Called once a frame.
export function draw_meter() {
  const at = state.dbfs.reduce((best, v, i) => v !== null && (best < 0 || v > state.dbfs[best]) ? i : best, -1);
  const below_db = at < 0 ? LEAST_LEVEL_DB : Math.max(LEAST_LEVEL_DB, Math.min(0, state.dbfs[at] - ceiling_dbfs()));
  const text = at < 0 ? "quiet" : `loudest: tactor ${state.hello.array.tactors[at].tactor ?? at}, ${Math.round(100 * 10 ** (below_db / 20))} %`;
  if (text === metered) return;
  metered = text;
  set_text("loudest", text);
  bar.style.width = `${100 * (1 - below_db / LEAST_LEVEL_DB)}%`;
}

on_change(() => {
  level.update();
  set_text("ceiling", `ceiling ${number_text(ceiling_dbfs(), 0)} dBFS`);
}, "level", "array");
