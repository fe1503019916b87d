// SPDX-License-Identifier: MIT
// The prediction, and faults of the take in plain words, with remedies.
import {state, changed, on_change, current_take, level_dbfs, say} from "../state.js";
import {by_id, make, set_text} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {set_option, edit_take, fit_take, algorithm} from "../takes/takes.js";
import {excess_db, limit_text, weaken_take} from "../service/planner.js";
import {path_word, lag_word, even_word, facts_text, number_text, fault_sentence} from "../words.js";
import {outside_mm} from "../geometry.js";
import {array} from "../drawing/view.js";

const OUTSIDE_MM = 0.5;

// Shows the prediction.
function show_predicted() {
  const errors = state.plan?.errors ?? {}, {rms_to_path_mm: mm, lag_s, speed_cv: cv} = errors, is_known = typeof mm === "number";
  by_id("pill").hidden = !is_known;
  by_id("predicted").title = facts_text(errors);
  set_text("pill-text", is_known ? `${number_text(mm)} mm` : "");
  by_id("predicted").replaceChildren(...!is_known
    ? [make("p", {class: "hint-text"}, state.plan_fault ? "There is no plan." : state.link === "lost" && current_take() ? "No connection: there is no plan." : "Shows what you would feel, once you draw.")]
    : [tile(number_text(mm), "mm", path_word(mm / array.pitch), lag_word(lag_s)),
      typeof cv !== "number" ? tile("–", "", "speed is not predicted") : tile(number_text(cv, 2), "CV", `${even_word(cv)} speed`)]);
}
const tile = (figure, unit, word, more = "") => make("div", {class: "tile"}, make("div", {}, make("b", {}, figure), make("small", {}, unit)),
  make("p", {}, word, make("i", {}, more)));

// Shows warnings in plain words, with remedies.
function show_warnings() {
  const found = [], take = current_take();
  if (state.plan_fault) found.push({text: fault_sentence(state.plan_fault), buttons: mending(state.plan_fault)});
  state.outside = [];
  if (array && take && !state.drawing) take.strokes.forEach(s => {
    const worst = s.timed.reduce((w, q) => { const off = outside_mm(array.edge, [q[1], q[2]]);
      return off > w.off ? {off, place: [q[1], q[2]]} : w; }, {off: OUTSIDE_MM, place: null});
    if (!worst.place) return;
    state.outside.push({...worst, name: take.strokes.length === 1 ? take.name : s.name});
  });
  if (state.outside.length && !take.leaves_array) found.push({...outside_text(),
    buttons: [[["Fit", make("span", {class: "long"}, " to array")], () => fit_take(array.edge)], ["Leave it", () => edit_take(() => ({leaves_array: true}))]]});
  const over_db = excess_db(state.plan), limit = over_db && take ? limit_text(state.plan, level_dbfs() + (take.gain_db ?? 0)) : "";
  const weaker_db = -(state.plan?.weakened_db ?? 0);
  if (weaker_db > 0 && take) found.push({text: `The take plays ${number_text(weaker_db)} dB weaker`, more: ", because its strokes meet on a tactor", buttons: []});
  if (over_db && take) found.push({text: `The take is ${number_text(over_db)} dB too strong`, more: limit && `: ${limit}`, buttons: [["Make this take weaker", () => weaken_take(current_take()).catch(e => say(fault_sentence(e)))]]});
  for (const w of new Set(state.plan?.warnings)) if (!w.kind && !/outside/.test(w)) found.push({text: w, buttons: []});
  const box = by_id("warnings"), more = found.length - 1;
  box.toggleAttribute("data-all", false);
  box.replaceChildren(...found.map(make_warning),
    more > 0 ? make("button", {class: "button small", onclick: () => box.toggleAttribute("data-all", true)}, `and ${more} more`) : "");
  by_id("pill").dataset.warn = found.length > 0;
  changed("frame");
}
function make_warning({text, more, buttons}) {
  const words = make("p", {}, text, more && make("span", {class: "long"}, more));
  const row = make("div", {class: "row"}, ...buttons.map(([t, f], i) => make("button", {class: i === 0 ? "button outlined" : "button", onclick: f}, t)));
  return make("div", {class: "warning"}, icon("warn"), make("div", {}, words, buttons.length > 0 && row));
}
function outside_text() {
  const n = state.outside.length, mm = Math.max(1, Math.round(Math.max(...state.outside.map(w => w.off))));
  const who = n === 1 ? `“${state.outside[0].name}” is` : `${n} strokes are`;
  return {text: `${who} up to ${mm} mm outside the array`, more: ", and felt at its edge there"};
}
const to_continuous = ["Use Continuous", () => set_option("algorithm", "continuous")];
function mending(f) {
  const name = /^options\.(\w+)/.exec(f.data?.what ?? "")?.[1];
  if (/options\.snap/.test(f.data?.hint ?? f.data?.why ?? "")) return [["Move its ends onto the grid", () => set_option("snap", true)], to_continuous];
  const list = name ? [["Use the default", () => set_option(name, null)]] : [];
  if (algorithm() !== "continuous") list.push(to_continuous);
  return list;
}

on_change(() => { show_predicted(); show_warnings(); }, "plan", "take", "array", "drawing");
