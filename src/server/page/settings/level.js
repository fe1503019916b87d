// The level: a fader on a scale of dBFS that also shows the loudest tactor. It cannot go beyond the owner's ceiling. Sounding strokes follow it.
import {state, changed, on_change, ceiling_dbfs, level_dbfs, SILENT_DB} from "../state.js";
import {by_id, make, listen, set_text} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {number_text} from "../words.js";

const LEAST_DB = -30, BEYOND_DB = 6; // ends of the scale, from the ceiling; its first place is silence
const MOST_JUMP_DB = 3; // largest step of a tap above the knob; dragging goes further
const STEP_DB = 0.5, KEY_DB = 1, PAGE_DB = 6, TICK_DB = 10;
const KEYS = {ArrowRight: KEY_DB, ArrowUp: KEY_DB, ArrowLeft: -KEY_DB, ArrowDown: -KEY_DB, PageUp: PAGE_DB, PageDown: -PAGE_DB,
  Home: -Infinity, End: Infinity};

const SILENCE_DB = LEAST_DB - STEP_DB;
const input = make("input", {id: "level-db", type: "range", min: SILENCE_DB, max: 0, step: STEP_DB});
const output = make("output", {for: "level-db"}), bar = make("i"), ticks = make("div", {class: "ticks", "aria-hidden": "true"});
const limited = db => db >= LEAST_DB ? Math.min(0, db) : SILENT_DB;
const place = db => 100 * (Math.max(SILENCE_DB, db) - SILENCE_DB) / (BEYOND_DB - SILENCE_DB); // per cent of the groove
let tapped = false;
function set_level(db) {
  state.level_db = limited(db);
  changed("level");
  show_level();
}
listen(input, "input", () => {
  const db = input.valueAsNumber;
  set_level(tapped ? Math.min(db, Math.max(LEAST_DB, state.level_db) + MOST_JUMP_DB) : db);
  tapped = false;
});
listen(input, "pointerdown", () => { tapped = true; });
// The browser reports a finger's tap after it has lifted.
listen(input, "click", () => { tapped = false; });
listen(input, "keydown", e => {
  tapped = false;
  if (!(e.key in KEYS) || e.ctrlKey || e.altKey || e.metaKey) return;
  e.preventDefault();
  set_level(KEYS[e.key] + (state.level_db < LEAST_DB ? LEAST_DB - KEY_DB : state.level_db));
});

function show_level() {
  const db = state.level_db, silent = db < LEAST_DB;
  input.value = silent ? SILENCE_DB : db;
  output.replaceChildren(...silent ? ["silent"] : [`${Math.round(100 * 10 ** (db / 20))} %`, make("small", {}, ` ${number_text(level_dbfs(), db % 1 ? 1 : 0)} dBFS`)]);
  input.setAttribute("aria-valuetext", output.textContent);
}
function show_scale() {
  const ceiling = ceiling_dbfs(), first = Math.ceil((ceiling + LEAST_DB) / TICK_DB) * TICK_DB, all = [];
  for (let v = first; v < ceiling - 4; v += TICK_DB) all.push(make("span", {"data-db": v}, all.length ? number_text(v, 0) : `${number_text(v, 0)} dBFS`));
  all.push(make("b", {"data-db": ceiling}, `ceiling ${number_text(ceiling, ceiling % 1 ? 1 : 0)}`));
  for (const t of all) t.style.left = `${place(t.dataset.db - ceiling)}%`;
  ticks.replaceChildren(...all);
}
const groove = make("div", {class: "groove"}, bar, make("div", {class: "beyond"}, icon("lock")), input);
groove.style.setProperty("--ceiling", `${place(0)}%`);
by_id("fader").append(make("div", {class: "row"}, make("label", {for: "level-db"}, "Level"), output, make("span", {class: "space"}),
  by_id("loudest")), groove, ticks);

let metered = "";
// Draws the meter; called once a frame.
export function draw_meter() {
  const at = state.dbfs.reduce((best, v, i) => v !== null && (best < 0 || v > state.dbfs[best]) ? i : best, -1);
  const below_db = at < 0 ? -Infinity : Math.min(0, state.dbfs[at] - ceiling_dbfs());
  const text = at < 0 ? "quiet" : `loudest: tactor ${at}, ${Math.round(100 * 10 ** (below_db / 20))} %`;
  if (text === metered) return;
  metered = text;
  set_text("loudest", text);
  bar.style.width = `${place(below_db)}%`;
}
on_change(show_level, "level", "array");
on_change(show_scale, "array");
show_scale();
show_level();
