// SPDX-License-Identifier: MIT
// Settings of the take. Options come from the service's table: options in OWN have special controls, all others are
// made from their rows.
import {state, changed, on_change, current_take, current_stroke} from "../state.js";
import {by_id, make, all_of, listen} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {slider, choice, toggle, entry, button, choose_by_arrows} from "./controls.js";
import {set_option, end_edit, edit_stroke, edit_take, put_stroke, row, value, algorithm} from "../takes/takes.js";
import {play_by} from "../service/player.js";
import {algorithm_picture, envelope_picture} from "./diagrams.js";
import {ALGORITHMS, PHANTOMS, OPTION_NAMES, error_facts, facts_text, short_facts, number_text, plain_name, seconds_text} from "../words.js";
import {duration_s, length_mm, with_duration, rebuild, find_speeds, editable, trimmed} from "../takes/stroke.js";
import {set_strength, strengths, set_speed, touch_curve} from "../time/curves.js";
import {toggle_compare} from "./compare.js";
import {LEAST_S, MOST_S} from "../time/time_axis.js";
import {starting_at, choose_clip} from "../time/clips.js";

// Tab for each heading of the table.
const TABS = {Place: "method", Timing: "timing", Sound: "vibration", Level: "vibration", Stroke: "timing"};
const IN_METHOD = new Set(["algorithm", "phantom", "faces", "snap", "drop_points", "overlap", "compensate", "sigma_mm",
  "sigma_v_mm_s", "observer"]);
const OWN = new Set(["algorithm", "phantom", "soa", "burst", "waveform", "carrier", "attack", "release", "phase", "level_dbfs",
  "duration", "speed", "intensity_max"]); // the last is for recordings: drawings here have 0 to 1
const OF_BRUSH = new Set(["snap", "drop_points", "overlap"]); // other algorithms do not have them

const ms = (v, digits = 0) => `${number_text(v * 1000, digits)} ms`;
const percent = v => `${Math.round(100 * v)} %`;
const tabs = [...all_of("[data-tab]")];

let controls = [], structure = "", all_phantoms = false;

// Joins controls and other elements into one control.
function join(tag, attributes, ...parts) {
  const joined = parts.filter(part => part?.update);
  return {element: make(tag, attributes, ...parts.map(part => part?.element ?? part)), update: () => joined.forEach(c => c.update())};
}
const more = (title, open, ...parts) => join("details", {class: "more", open}, make("summary", {}, title), ...parts);

// Panes.
const algorithm_choice = () => cards("Algorithm", "algorithm", ALGORITHMS, algorithm_picture);
const phantom_choice = () => cards("Phantom: how tactors share a point", "phantom", PHANTOMS);
// Cards with a picture have the number of the chosen one; of the others the chosen one is shown, and all after More.
function cards(label, name, words, picture) {
  const values = (row(name)?.choices ?? Object.keys(words)).map(id => {
    const error = picture && make("span", {class: "error"}), [title, text] = words[id] ?? [plain_name(id), ""];
    return {value: id, content: [picture?.(id), make("b", {}, title), error, make("p", {}, text)].filter(Boolean), update: b => {
      const e = value(name) === id ? state.plan?.errors : null;
      if (picture) { error.textContent = short_facts(e ?? {}); error.title = facts_text(e); } else b.hidden = !all_phantoms && value(name) !== id;
    }};
  });
  const list = choice({label, visible_label: false, shape: picture ? "cards large" : "cards", get: () => value(name), set: v => set_option(name, v), values,
    hold: v => play_by({[name]: v})});
  return join("section", {}, make("h2", {}, label), list, picture
    ? make("p", {class: "hint-text"}, "Hold a method down to feel the take with it.")
    : button("More", null, e => { all_phantoms = !all_phantoms; e.currentTarget.setAttribute("aria-expanded", all_phantoms); list.update(); },
      {class: "button small outlined", "aria-label": "More phantoms", "aria-expanded": String(all_phantoms)}));
}
function all_errors() {
  const o = row("observer"), observer = choice({label: "Predicted by", get: () => state.observer ?? o?.default ?? "centroid",
    set: v => { state.observer = v; changed("observer"); },
    values: (o?.choices ?? ["centroid", "low-speed"]).map(v => ({value: v, name: plain_name(v)}))});
  const list = make("dl", {id: "all-errors"});
  return join("details", {class: "more"}, make("summary", {}, "All predicted errors"), observer, {element: list, update() {
    const facts = error_facts(state.plan?.errors ?? {});
    list.replaceChildren(...facts.length > 0 ? facts.flatMap(([name, text]) => [make("dt", {}, name), make("dd", {}, text)])
      : [make("dd", {}, "There is no prediction.")]);
  }});
}

// Controls of the stroke that is edited; hidden without one.
const stroke = () => editable(current_stroke());
function pace_controls() {
  const kinds = [["even", "Even"], ["soft", "Soft ends"], ["reach", "Like a reach"], ["drawn", "As drawn"]];
  const parts = ["at the start", "at a quarter", "half-way", "at three quarters", "at the end"];
  const duration = slider({label: "Duration", least: LEAST_S, most: MOST_S, log: true, get: () => duration_s(stroke()),
    set: v => edit_stroke(s => with_duration(s, Math.min(MOST_S, +v.toPrecision(3))), "duration"), done: end_edit,
    text: v => v < 1 ? ms(v) : seconds_text(v)});
  const along = {element: make("p", {class: "hint-text"}), update() {
    const s = stroke(), mm = length_mm(s.timed);
    this.element.textContent = `${Math.round(mm / duration_s(s))} mm/s along ${Math.round(mm)} mm`;
  }};
  const movement = choice({label: "Movement", get: () => stroke().pace.kind,
    set: kind => edit_stroke(s => rebuild({...s, drawn: s.drawn ?? (s.pace.kind === "drawn" ? s.pace : null),
      pace: kind === "drawn" ? s.drawn ?? s.pace : {kind}})),
    values: kinds.map(([kind, name]) => ({value: kind, name,
      update: b => { b.hidden = kind === "drawn" && !stroke().drawn && stroke().pace.kind !== "drawn"; }}))});
  const speeds = parts.map((word, i) => slider({label: `Speed ${word}`, least: 0.1, most: 5, log: true, get: () => find_speeds(stroke().pace)[i][1],
    set: v => set_speed(i, v, `speed ${i}`), done: end_edit, text: percent}));
  let strong = [];
  const strong_controls = {element: make("div"), update() {
    if (strengths().length !== strong.length) {
      strong = strengths().map((_, i) => slider({label: `Strength, point ${i + 1}`, least: 0, most: 1, get: () => strengths()[i][1],
        set: v => set_strength(i, v, `strength ${i}`), done: end_edit, text: percent}));
      this.element.replaceChildren(...strong.map(c => c.element));
    }
    strong.forEach(c => c.update());
  }};
  return join("section", {}, make("h2", {}, "Stroke"), duration, along, movement,
    more("Speed and strength along the path", false, ...speeds, strong_controls));
}
// Makes controls of the take's strokes: the edited stroke, its start, and its trimmed part.
function stroke_controls() {
  const take = current_take(), many = take.strokes.length > 1, number = {unit: "s", numeric: true};
  const which = many && choice({label: "Stroke", get: () => state.stroke, set: choose_clip, values: take.strokes.map((s, i) => ({value: i, name: s.name}))});
  const cut = (label, change) => entry({...number, label, get: () => "", hint: "0", set: v => v > 0 && put_stroke(s => change(s, v, duration_s(s)))});
  return more("Place in time", many, which,
    entry({...number, label: "Starts at", get: () => +stroke().start_s.toFixed(3), set: v => put_stroke(s => starting_at(s, v ?? 0))}),
    cut("Cut off its start", (s, v, long) => trimmed(s, Math.min(v, long - LEAST_S), long)),
    cut("Cut off its end", (s, v, long) => trimmed(s, 0, Math.max(LEAST_S, long - v))),
    many && button("Delete this stroke", "bin", () => edit_take(t => ({strokes: t.strokes.filter((_, i) => i !== state.stroke)}))));
}

// Timing law, with the take's own values.
const slope = () => value("slope") ?? 0.32, intercept = () => value("intercept") ?? 0.0473;
const soa = () => value("soa") ?? 0.07, burst = () => value("burst") ?? (soa() - intercept()) / slope();
const option_slider = (name, more) => slider({label: OPTION_NAMES[name], set: v => set_option(name, v), done: end_edit, ...more});
function burst_controls() {
  const bursts = option_slider("burst", {least: 0.005, most: 0.4, step: 0.001, get: burst, text: v => ms(v)});
  const interval = option_slider("soa", {least: 0.02, most: 0.4, step: 0.001, get: soa, text: v => ms(v), set: v => {
    if (value("burst") === null && v > 0.07) set_option("burst", +burst().toFixed(4), "option soa");
    set_option("soa", v);
  }});
  const law = {element: make("div", {class: "law row hint-text"}), update() {
    const wanted = slope() * burst() + intercept(), wanted_ms = Math.round(wanted * 1000), off = Math.round((soa() - wanted) * 1000);
    const sum = `${+slope().toFixed(3)} × ${Math.round(burst() * 1000)} + ${Math.round(intercept() * 1000)} = ${wanted_ms} ms`;
    this.element.classList.toggle("off", off !== 0);
    if (off === 0) return this.element.replaceChildren(icon("check"), make("span", {}, "On the law: ", make("b", {}, sum)));
    this.element.replaceChildren(icon("warn"),
      make("span", {}, `${Math.abs(off)} ms ${off < 0 ? "shorter than the law: may blur" : "longer than the law: may be felt as taps"}`),
      button(`Use ${wanted_ms} ms`, null, () => set_option("soa", +wanted.toFixed(4))));
  }};
  return join("section", {}, make("h2", {}, "Bursts"), bursts, interval, law);
}

const WAVE_NAMES = [["sine", "Sine"], ["square", "Square"], ["triangle", "Triangle"], ["sawtooth", "Saw"], ["noise", "Noise"]];
function vibration_controls() {
  const kind = () => String(value("waveform") ?? "sine").split(":")[0];
  const wave = choice({label: "Waveform", get: kind, set: v => set_option("waveform", v === "noise"
    ? "noise:100-400" : v),
    values: WAVE_NAMES.map(([value, name]) => ({value, name}))});
  const noise = entry({label: "Noise from – to, Hz", get: () => String(value("waveform")).split(":")[1] ?? "",
    set: v => set_option("waveform", v ? `noise:${v}` : null), hint: "100-400"});
  const carrier = option_slider("carrier", {least: 20, most: 1000, log: true, step: 1, get: () => value("carrier") ?? 250, text: v => `${Math.round(v)} Hz`});
  const attack = () => value("attack") ?? value("ramp") ?? 0.002, release = () => value("release") ?? attack();
  const envelope = {least: 0, most: 0.05, step: 0.0005, text: v => ms(v, 1)};
  const phase_row = row("phase"), through = phase_row?.choices?.[0];
  const phase = toggle({label: "One carrier for the whole stroke", hint: "Off: it starts again with each burst",
    get: () => (value("phase") ?? through) === through, set: on => set_option("phase", on ? null : phase_row?.choices?.[1])});
  const picture = {element: make("div", {class: "picture"}), update() {
    noise.element.hidden = kind() !== "noise";
    this.element.replaceChildren(envelope_picture(algorithm() === "park2016" ? Math.max(0.01, burst()) : 0.07, attack(), release(),
      value("carrier") ?? 250, value("envelope")));
  }};
  return join("section", {}, wave, noise, carrier, make("p", {class: "hint-text"}, "Skin is most sensitive near 250 Hz."),
    make("h2", {class: "apart"}, "Envelope of a burst"), picture, option_slider("attack", {...envelope, get: attack}),
    option_slider("release", {...envelope, get: release}), phase);
}

// Makes a control from a row of the table.
function from_row(o) {
  const label = OPTION_NAMES[o.name] ?? plain_name(o.name), get = () => value(o.name), set = v => set_option(o.name, v);
  const hint = o.help.charAt(0).toUpperCase() + o.help.slice(1);
  let c;
  if (o.kind === "flag") c = toggle({label, hint, get, set});
  else if (o.kind === "choice") c = choice({label, get, set, values: o.choices.map(v => ({value: v, name: plain_name(v)}))});
  else c = entry({label, get, set, unit: o.unit, numeric: o.kind !== "text", hint: o.default === null ? "" : String(o.default)});
  c.element.title = hint;
  return c;
}
function others(tab) {
  const list = state.options.filter(o => !OWN.has(o.name) && (IN_METHOD.has(o.name) ? "method" : TABS[o.group] ?? "method") === tab
    && (!OF_BRUSH.has(o.name) || algorithm() === "tactile-brush"));
  return list.length > 0 && more("More settings", list.some(o => current_take()?.options[o.name] !== undefined), ...list.map(from_row));
}

function build() {
  const names = current_take()?.strokes.map(s => s.name) ?? [];
  const now = JSON.stringify([state.tab, state.options.length, algorithm(), names, document.documentElement.dataset.theme]);
  if (now === structure) return;
  structure = now;
  const parts = {
    method: () => [algorithm_choice(), phantom_choice(), button("Compare two by feeling", null, toggle_compare, {class: "button outlined"}), all_errors(), others("method")],
    timing: () => [current_stroke() && pace_controls(), current_stroke() && stroke_controls(), algorithm() === "park2016" && burst_controls(),
      others("timing")],
    vibration: () => [vibration_controls(), others("vibration")],
  }[state.tab]().filter(Boolean);
  controls = parts.filter(part => part.update);
  by_id("pane").replaceChildren(...parts.map(part => part.element ?? part));
  by_id("pane").setAttribute("aria-labelledby", `tab-${state.tab}`);
  for (const b of tabs) {
    b.setAttribute("aria-selected", b.dataset.tab === state.tab);
    b.tabIndex = b.dataset.tab === state.tab ? 0 : -1;
  }
}
for (const b of tabs) listen(b, "click", () => { state.tab = b.dataset.tab; changed("tab"); });
choose_by_arrows(by_id("tabs"), tabs);
// The curve of a slider that is touched stands out.
listen("pane", "focusin", e => touch_curve(/^(speed|strength)/.exec(e.target.labels?.[0]?.textContent.toLowerCase())?.[0] ?? ""));

on_change(what => {
  if (state.drawing && !what.has("drawing") || state.tried) return;
  build();
  controls.forEach(c => c.update());
}, "take", "plan", "tab", "array", "options", "theme", "level", "observer", "drawing");
