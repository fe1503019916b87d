// SPDX-License-Identifier: MIT
// Controls that stand for a value: each has an element, and an update that shows the value again.
import {make, listen} from "../../../net/page/dom.js";
import {icon} from "../look.js";

let last_id = 0;
const ids = () => `c${++last_id}`;

// A slider. `to` and `from` map a value to 0..1000 and back, so that ranges can be logarithmic.
export function slider({label, get, set, least, most, text, done, step = 0, log = false, described}) {
  const id = ids(), output = make("output", {for: id});
  const to = v => log ? 1000 * Math.log(v / least) / Math.log(most / least) : 1000 * (v - least) / (most - least);
  const from = p => {
    const v = log ? least * (most / least) ** (p / 1000) : least + (most - least) * p / 1000;
    return Math.min(most, Math.max(least, step ? Math.round(v / step) * step : +v.toPrecision(4)));
  };
  const input = make("input", {id, type: "range", min: 0, max: 1000, step: step && !log ? 1000 * step / (most - least) : 1,
    "aria-describedby": described});
  listen(input, "input", () => { set(from(Number(input.value))); update(); });
  listen(input, "change", () => done?.());
  function update() {
    const v = get(), p = Math.min(1000, Math.max(0, to(v)));
    if (document.activeElement !== input || Math.abs(Number(input.value) - p) > 2) input.value = p;
    input.style.setProperty("--part", `${p / 10}%`);
    const said = text(v);
    output.replaceChildren(...Array.isArray(said) ? [said[0], make("small", {}, ` ${said[1]}`)] : [said]);
    input.setAttribute("aria-valuetext", output.textContent);
  }
  update();
  return {element: make("div", {class: "slider"}, make("label", {for: id}, label), output, input), update, input};
}

// Buttons of which one is chosen; arrows move, as in any group of radio buttons.
export function choice({label, get, set, values, shape = "segments", visible_label = true}) {
  const buttons = values.map(v => make("button", {role: "radio", "data-value": v.value,
    onclick: () => pick(v.value)}, ...v.content ?? [v.name]));
  const group = make("div", {role: "radiogroup", "aria-label": label, class: shape}, ...buttons);
  listen(group, "keydown", e => {
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[e.key];
    if (!step) return;
    e.preventDefault();
    const at = buttons.indexOf(document.activeElement), next = buttons[(at + step + buttons.length) % buttons.length];
    next.focus();
    next.click();
  });
  function pick(v) { set(v); update(); }
  function update() {
    const now = get();
    const any = values.some(v => v.value === now);
    buttons.forEach((b, i) => {
      const on = values[i].value === now;
      b.setAttribute("aria-checked", on);
      b.tabIndex = on || (!any && i === 0) ? 0 : -1;
    });
    values.forEach((v, i) => v.update?.(buttons[i]));
  }
  update();
  const element = visible_label ? make("div", {class: "field"}, make("div", {class: "label"}, label), group) : group;
  return {element, update, buttons};
}

export function toggle({label, hint, get, set}) {
  const b = make("button", {role: "switch", class: "switch", onclick: () => { set(!get()); update(); }},
    make("span", {}, label, hint && make("small", {}, hint)), make("i"));
  const update = () => b.setAttribute("aria-checked", Boolean(get()));
  update();
  return {element: b, update};
}

// A text or a number that is typed; a wrong one is told by the service.
export function entry({label, get, set, hint, unit, numeric}) {
  const id = ids(), input = make("input", {id, type: "text", inputmode: numeric ? "decimal" : null, autocomplete: "off",
    spellcheck: "false", placeholder: hint});
  listen(input, "change", () => {
    const text = input.value.trim();
    if (text === "") return set(null);
    const v = numeric ? Number(text.replace(",", ".").replace("−", "-")) : text;
    if (numeric && !Number.isFinite(v)) return update(true);
    set(v);
  });
  function update(always = false) { if (always === true || document.activeElement !== input) input.value = get() ?? ""; }
  update();
  return {element: make("div", {class: "entry"}, make("label", {for: id}, label), input, unit && make("span", {}, unit)), update};
}

export const button = (text, name, onclick, more = {}) => make("button", {class: "button", onclick, ...more},
  name && icon(name), text);
