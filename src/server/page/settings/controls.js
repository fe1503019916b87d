// SPDX-License-Identifier: MIT
// Controls of a value: each has an element, and an update() that shows the value again.
import {make, listen} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {clamp} from "../geometry.js";
import {on_hold} from "../service/hold.js";

let last_id = 0;
const new_id = () => `c${++last_id}`;

// Makes a slider. `to` and `from` map a value to 0..1000 and back, so that ranges can be logarithmic.
export function slider({label, get, set, least, most, text, done, step = 0, log = false}) {
  const id = new_id(), output = make("output", {for: id});
  const to = v => log ? 1000 * Math.log(v / least) / Math.log(most / least) : 1000 * (v - least) / (most - least);
  const from = p => {
    const v = log ? least * (most / least) ** (p / 1000) : least + (most - least) * p / 1000;
    return clamp(step ? Math.round(v / step) * step : +v.toPrecision(4), least, most);
  };
  const input = make("input", {id, type: "range", min: 0, max: 1000, step: step && !log ? 1000 * step / (most - least) : 1});
  listen(input, "input", () => { set(from(Number(input.value))); update(); });
  listen(input, "change", () => done?.());
  function update() {
    const v = get(), p = clamp(to(v), 0, 1000);
    if (document.activeElement !== input || Math.abs(Number(input.value) - p) > 2) input.value = p;
    input.style.setProperty("--part", `${p / 10}%`);
    const words = text(v);
    output.replaceChildren(...Array.isArray(words) ? [words[0], make("small", {}, ` ${words[1]}`)] : [words]);
    input.setAttribute("aria-valuetext", output.textContent);
  }
  update();
  return {element: make("div", {class: "slider"}, make("label", {for: id}, label), output, input), update, input};
}

// Lets arrow keys choose the next or the previous button.
export function choose_by_arrows(group, buttons) {
  listen(group, "keydown", e => {
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[e.key];
    if (!step) return;
    e.preventDefault();
    const next = buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length];
    next.click(); // shows it, if it was hidden
    next.focus();
  });
}
// Makes buttons of which one is chosen. Arrow keys move, as in any group of radio buttons.
// `hold(value)` begins what lasts while a button is held.
export function choice({label, get, set, values, shape = "segments", visible_label = true, hold}) {
  const buttons = values.map(v => make("button", {role: "radio", "data-value": v.value,
    onclick: () => { set(v.value); update(); }}, ...v.content ?? [v.name]));
  const group = make("div", {role: "radiogroup", "aria-label": label, class: shape}, ...buttons);
  choose_by_arrows(group, buttons);
  if (hold) buttons.forEach((b, i) => on_hold(b, () => hold(values[i].value)));
  function update() {
    const at = values.findIndex(v => v.value === get());
    buttons.forEach((b, i) => {
      b.setAttribute("aria-checked", i === at);
      b.tabIndex = i === Math.max(0, at) ? 0 : -1;
      values[i].update?.(b);
    });
  }
  update();
  return {element: visible_label ? make("div", {class: "field"}, make("div", {}, label), group) : group, update};
}

export function toggle({label, hint, get, set}) {
  const b = make("button", {role: "switch", class: "switch", onclick: () => { set(!get()); update(); }},
    make("span", {}, label, hint && make("small", {}, hint)), make("i"));
  const update = () => b.setAttribute("aria-checked", Boolean(get()));
  update();
  return {element: b, update};
}

// Makes a field for a text or a number; the service checks it.
export function entry({label, get, set, hint, unit, numeric}) {
  const id = new_id(), input = make("input", {id, type: "text", inputmode: numeric ? "decimal" : null, autocomplete: "off",
    spellcheck: "false", placeholder: hint});
  listen(input, "change", () => {
    const text = input.value.trim();
    if (text === "") return set(null);
    const v = numeric ? Number(text.replace(",", ".").replace("−", "-")) : text;
    if (numeric && !Number.isFinite(v)) return update(true);
    set(v);
  });
  function update(always = false) { if (always || document.activeElement !== input) input.value = get() ?? ""; }
  update();
  return {element: make("div", {class: "entry"}, make("label", {for: id}, label), input, unit && make("span", {}, unit)), update};
}

export const button = (text, name, onclick, more = {}) => make("button", {class: "button", onclick, ...more},
  name && icon(name), text);
