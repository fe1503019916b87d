// SPDX-License-Identifier: MIT
// The studio: buttons that belong to no other module, frames, and the start.
import {state, changed, on_change, current_take, current_stroke, is_simulated, say, remember, remembered, now_ms, SILENT_DB} from "./state.js";
import {by_id, make, on_click, show_pressed, all_of, listen, set_text} from "../../net/page/dom.js";
import {place_icons, forget_colours, is_dark} from "./look.js";
import {connect, call, on_hello} from "./service/connection.js";
import {undo, redo, can_undo, can_redo, steps_of_undo, restore_undo, rename_take} from "./takes/takes.js";
import {open_takes, write_at_once} from "./takes/keeping.js";
import {clamp} from "./geometry.js";
import {draw_frame, moves} from "./drawing/canvas.js";
import {view, set_array, look_at_all, resize, place_in_page} from "./drawing/view.js";
import {label_boxes} from "./drawing/labels.js";
import {felt_points} from "./drawing/felt.js";
import {draw_lanes, clock_text} from "./time/lanes.js";
import {handles} from "./time/curves.js";
import "./time/timeline.js";
import {play, stop, tick, silence_speaker, unanswered_s, stop_words} from "./service/player.js";
import {change_point, remove_point, finish_early} from "./drawing/pointer.js";
import "./takes/takes_panel.js";
import {draw_card, open_tour} from "./takes/gallery.js";
import "./service/simulated.js";
import {own_name} from "./service/device.js";
import {choose_tool, new_take, open_sheet, fold_time} from "./settings/keys.js";
import {full, lane_tactors, lane_height, show_all_time} from "./time/time_axis.js";
import "./takes/files.js";
import "./takes/shape_switch.js";
import "./settings/inspector.js";
import {draw_meter} from "./settings/level.js";
import "./settings/prediction.js";
import {seconds_text} from "./words.js";
import {length_mm, editable, total_s} from "./takes/stroke.js";

const DONE_MS = 600; // time for which the button says that it has stopped
const SWITCHES = ["loop", "speaker", "scrub"]; // buttons, and parts of the state

// Light and dark.
const dark = matchMedia("(prefers-color-scheme: dark)");
function set_theme(theme) {
  document.documentElement.dataset.theme = theme ?? (dark.matches ? "dark" : "light");
  document.querySelector('meta[name="theme-color"]').content = is_dark() ? "#15181b" : "#f8f7f4";
  forget_colours();
  changed("theme");
}
set_theme(remembered("theme"));
// A page that is opened again is not louder than before.
state.level_db = clamp(Number(remembered("level") ?? 0) || 0, SILENT_DB, 0);
on_change(() => remember("level", state.level_db), "level");
listen(dark, "change", () => { if (!remembered("theme")) set_theme(null); });
on_click("theme", () => {
  const theme = is_dark() ? "light" : "dark";
  remember("theme", theme);
  set_theme(theme);
});
place_icons();

// Buttons.
on_click("play", () => play());
// Stop acts on touch-down, whatever other fingers do; a click without a pointer comes from keys and assistive technology.
listen("stop", "pointerdown", e => { if (e.button === 0) stop(); });
on_click("stop", e => { if (e.detail === 0) stop(); });
on_click("undo", undo);
on_click("redo", redo);
on_click("new-take", () => { new_take(); say("Draw a new take"); });
on_click("show-all", () => { look_at_all(); show_all_time(); });
// The keys of a headset and of a screen that is locked.
for (const key of ["pause", "stop"]) navigator.mediaSession?.setActionHandler(key, stop);
for (const name of SWITCHES) on_click(name, () => { state[name] = !state[name]; changed("playing", "curves"); });
on_click("scrub", () => say(`Scrubbing is ${state.scrub ? "felt" : "silent"}`));
on_click("speaker", () => {
  if (!state.speaker) return silence_speaker();
  say(is_simulated() ? "You hear it while you draw" : "Play uses this computer's loudspeakers, too; they must not be on the array's card");
});
on_click("point-curve", () => change_point({corner: false}));
on_click("point-corner", () => change_point({corner: true}));
on_click("point-bin", remove_point);
on_click("time-fold", fold_time);
for (const b of all_of("[data-press]")) listen(b, "click", () => {
  const pressed = by_id(b.dataset.press);
  if (pressed.popover) pressed.showPopover(); else pressed.click();
});
listen("p-more", "click", () => by_id("p-more").hidePopover(), {capture: true}); // before what it shows
on_click("pill", () => open_sheet("inspector"));
on_click("settings", () => open_sheet(document.body.dataset.sheetOpen ? "" : state.sheet || "inspector"));
on_click("sheet-close", () => open_sheet(""));
on_click("gallery-open", () => open_sheet(""));
on_click("tour-open", () => { open_sheet(""); open_tour(); });
for (const b of all_of("button[data-tool]")) listen(b, "click", () => choose_tool(b.dataset.tool));
for (const b of all_of("button[data-sheet]")) listen(b, "click", () => open_sheet(b.dataset.sheet));

// Texts and states of buttons.
on_change(() => {
  const take = current_take(), p = state.playing;
  by_id("undo").disabled = !can_undo();
  by_id("redo").disabled = !can_redo();
  by_id("play").disabled = !take?.strokes.length;
  by_id("play").dataset.on = p !== null;
  set_text("play-text", p ? "Playing" : "Play");
  show_stop();
  for (const name of SWITCHES) show_pressed(by_id(name), state[name]);
  for (const b of all_of("button[data-tool]")) show_pressed(b, b.dataset.tool === state.tool);
  by_id("field").dataset.tool = state.tool;
  const shown = state.drawing && !state.drawing.append ? null : take;
  set_text("take-name", shown?.name ?? "New take");
  set_text("take-facts", take_facts(shown));
  by_id("legend").hidden = state.takes.length > 0;
  by_id("no-lanes").hidden = Boolean(take?.strokes.length || state.drawing);
  show_point();
});
function show_stop() {
  const late_s = unanswered_s(), done = !state.stopping && state.stopped && now_ms() - state.stopped.at < DONE_MS;
  by_id("stop").dataset.state = late_s ? "late" : done ? "done" : "";
  const label = late_s ? "Stop again" : done ? "Stopped" : "Stop", span = by_id("stop").querySelector("span");
  if (span.textContent !== label) span.replaceChildren(label, ...late_s ? [make("small", {}, `${stop_words()[0]}, ${late_s.toFixed(1)} s`)] : []);
  if (done) setTimeout(() => changed("link"), DONE_MS);
}
function take_facts(take) {
  if (!take?.strokes.length) return "";
  const bursts = state.plan && !state.plan.continuous ? `${state.plan.onsets.length} bursts, ` : "";
  const mm = take.strokes.reduce((sum, s) => sum + length_mm(s.timed), 0);
  return `${bursts}${Math.round(mm)} mm in ${seconds_text(total_s(take.strokes))}`;
}
function show_point() {
  const s = current_stroke(), on_point = state.tool === "points" && s && state.knot >= 0;
  by_id("points").hidden = !on_point;
  if (!on_point) return;
  const knots = editable(s).knots, k = knots[Math.min(state.knot, knots.length - 1)];
  set_text("point-text", `Point ${state.knot + 1} of ${knots.length}`);
  show_pressed(by_id("point-curve"), !k.corner);
  show_pressed(by_id("point-corner"), k.corner);
}

// Frames: only while something moves or has changed.
let running = false;
function frame() {
  tick();
  draw_frame();
  draw_lanes();
  draw_meter();
  draw_card();
  const [now, total] = clock_text(), text = `${now} of ${total}`, slider = by_id("lanes");
  set_text("clock", now);
  set_text("total", total);
  running = moves();
  if (running) return requestAnimationFrame(frame);
  if (slider.getAttribute("aria-valuetext") === text) return;
  slider.setAttribute("aria-valuenow", now);
  slider.setAttribute("aria-valuemax", parseFloat(total) || 0);
  slider.setAttribute("aria-valuetext", text);
}
function wake() { if (!running) { running = true; requestAnimationFrame(frame); } }
on_change(wake);
setInterval(() => { if (state.dbfs.some(v => v !== null) || state.touches.size) wake(); }, 33);

new ResizeObserver(() => { resize(); changed("frame"); }).observe(by_id("stage"));
addEventListener("beforeunload", e => { if (state.unkept.size) e.preventDefault(); });
addEventListener("pagehide", () => { finish_early(); write_at_once(); });
// Draws everything again if the screen's density changes, which leaves the size of the page the same.
(function watch_density() {
  listen(matchMedia(`(resolution: ${devicePixelRatio}dppx)`), "change", () => { changed("layout"); watch_density(); }, {once: true});
})();

// The start.
on_hello(async h => {
  set_array(h.array);
  try { state.options = (await call("options")).options; } catch (e) { if (e.code === 0) throw e; }
  changed("array", "options", "take");
});
open_takes(steps_of_undo, restore_undo);
connect(own_name());
changed("takes", "take", "theme", "tool");

// For the console, and for tests.
globalThis.tactor = {state, changed, place_in_page, rename: rename_take, view, lanes: full, label_boxes, lane_tactors, lane_height, felt_points, curve_points: handles};
