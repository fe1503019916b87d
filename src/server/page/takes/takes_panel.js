// SPDX-License-Identifier: MIT
// The list of takes.
import {state, on_change, ceiling_dbfs} from "../state.js";
import {by_id, make, all_of, listen, set_text} from "../../../net/page/dom.js";
import {icon, is_dark, colour, disc, paint, plot} from "../look.js";
import {BIN_DAYS, DAY_MS} from "./keeping.js";
import {choose_take, rename_take, duplicate_take, delete_take, bring_back, fit_take, take_s} from "./takes.js";
import {end_s, interpolate, total_s} from "./stroke.js";
import {array} from "../drawing/view.js";
import {viridis} from "../../../net/page/viridis.js";
import {seconds_text} from "../words.js";

const SIZE = 48;
const rows = new Map(); // by take: {take, element}
const seen = new IntersectionObserver(list => list.filter(e => e.isIntersecting).forEach(e => { seen.unobserve(e.target);
  e.target.draw(); }), {rootMargin: "300px"});

// Makes a small picture of strokes over the tactors, which is drawn when it comes into view.
export function thumb(strokes) {
  const c = make("canvas", {class: "thumb", width: SIZE * 2, height: SIZE * 2, "aria-hidden": "true"});
  c.draw = () => draw_thumb(c, strokes);
  seen.observe(c);
  return c;
}
// Draws it. With a moment, shows the strokes while they play: the strength of each tactor, and the place of each stroke.
export function draw_thumb(c, strokes, at_s = null) {
  if (!array) return;
  const p = c.getContext("2d"), side = Math.max(...array.box.size, 1), scale = SIZE * 2 * 0.68 / side;
  const at = (x, y) => [SIZE + (x - array.box.middle[0]) * scale, SIZE + (y - array.box.middle[1]) * scale];
  p.clearRect(0, 0, c.width, c.height);
  p.fillStyle = colour("line2");
  for (const q of array.places) { disc(p, at(...q), 3.5); p.fill(); }
  p.lineWidth = 5; p.lineCap = "round";
  const total = Math.max(0.01, total_s(strokes));
  for (const s of strokes) {
    const step = Math.max(1, Math.floor(s.timed.length / 40));
    for (let i = 0; i + 1 < s.timed.length; i += step) {
      const a = s.timed[i], b = s.timed[Math.min(s.timed.length - 1, i + step)];
      p.strokeStyle = viridis((s.start_s + a[0]) / total, is_dark());
      plot(p, at(a[1], a[2]), at(b[1] + 1e-3, b[2])); p.stroke();
    }
  }
  if (at_s === null) return;
  array.places.forEach((q, i) => {
    const share = 10 ** (((state.dbfs[i] ?? -Infinity) - ceiling_dbfs()) / 20);
    if (share > 0.01) { disc(p, at(...q), 10 * Math.sqrt(Math.min(1, share))); paint(p, {fill: "felt"}); }
  });
  for (const s of strokes) {
    if (at_s < s.start_s || at_s > end_s(s)) continue;
    disc(p, at(...interpolate(s.timed, at_s - s.start_s).slice(1, 3)), 7);
    paint(p, {fill: "skin", line: "ink", width: 3});
  }
}
export const facts = t => `${t.strokes.length > 1 ? `${t.strokes.length} strokes` : t.origin}, ${seconds_text(take_s(t)).replace(" ", "\u00a0")}`;

const row_note = t => state.unkept.has(t.id) ? "not kept" : state.elsewhere.has(t.id) ? "changed in another tab" : "";

function make_row(take) {
  const kept = rows.get(take.id), note = row_note(take);
  if (kept?.take === take && kept.note === note) return kept.element;
  const element = make("li", {}, make("button", {class: "take", onclick: () => choose_take(take.id)},
    thumb(take.strokes), make("span", {}, make("b", {}, take.name), make("small", {class: note && "note"}, note || facts(take)))),
    make("button", {class: "button more-button", "aria-label": `More about ${take.name}`,
      onclick: e => menu(take, e.currentTarget)}, icon("more")));
  rows.set(take.id, {take, note, element});
  return element;
}
function menu(take, at) {
  const m = by_id("p-take"), item = (text, name, f) => make("button", {class: "button",
    onclick: () => { m.hidePopover(); f(); }}, icon(name), text);
  m.replaceChildren(item("Rename", "rename", () => rename(take)), item("Duplicate", "copy", () => duplicate_take(take.id)),
    item("Fit to array", "all", () => { choose_take(take.id); if (array && take.strokes.length) fit_take(array.edge); }),
    item("Delete", "bin", () => delete_take(take.id)));
  m.showPopover();
  m.firstChild.focus();
  const r = at.getBoundingClientRect();
  m.style.inset = `${Math.min(innerHeight - 204, r.bottom + 4)}px auto auto ${Math.max(8, Math.min(innerWidth - 200, r.right - 190))}px`;
}
function rename(take) {
  const li = rows.get(take.id).element, input = make("input", {class: "rename", type: "text", "aria-label": "Name",
    maxlength: 60, ".value": take.name});
  const end = keep => { input.remove(); if (keep) rename_take(take.id, input.value); };
  listen(input, "keydown", e => { if (e.key === "Enter") input.blur();
    if (e.key === "Escape") { e.stopPropagation(); input.value = take.name; input.blur(); } });
  listen(input, "blur", () => end(input.value !== take.name), {once: true});
  li.append(input);
  input.focus();
  input.select();
}

// The bin.
const days = t => Math.floor((Date.now() - t.deleted) / DAY_MS);
const when = n => n === 0 ? "today" : n === 1 ? "yesterday" : `${n} days ago`;
let binned = [];
function show_bin() {
  by_id("bin").hidden = !state.bin.length;
  if (binned.length === state.bin.length && binned.every((t, i) => t === state.bin[i])) return;
  binned = state.bin;
  set_text("bin-text", `${binned.length}, kept for ${BIN_DAYS} days`);
  by_id("binned").replaceChildren(...[...binned].sort((a, b) => b.deleted - a.deleted).map(t => make("li", {}, thumb(t.strokes),
    make("span", {}, make("b", {}, t.name), make("small", {}, `deleted ${when(days(t))}, ${BIN_DAYS - 1 - days(t)} days left`)),
    make("button", {class: "button small outlined", onclick: () => bring_back(t.id)}, "Bring back"))));
}

let listed = [], noted = "";
function show_takes() {
  show_bin();
  const list = by_id("takes"), now = state.takes, notes = [...state.unkept, "", ...state.elsewhere].join();
  if (listed.length !== now.length || notes !== noted || now.some((t, i) => t !== listed[i])) {
    noted = notes;
    const elements = now.map(make_row), wanted = new Set(now.map(t => t.id));
    for (const id of [...rows.keys()]) if (!wanted.has(id)) rows.delete(id);
    // Moves only elements that differ, which keeps a list of a thousand quick.
    elements.forEach((e, i) => { if (list.children[i] !== e) list.insertBefore(e, list.children[i] ?? null); });
    while (list.children.length > elements.length) list.lastChild.remove();
    listed = now;
  }
  for (const b of list.querySelectorAll('[aria-current="true"]')) b.removeAttribute("aria-current");
  rows.get(state.current)?.element.firstChild.setAttribute("aria-current", "true");
}
on_change(show_takes, "takes", "take");
on_change(() => all_of(".thumb").forEach(c => c.draw()), "theme", "array");
