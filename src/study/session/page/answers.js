// SPDX-License-Identifier: MIT
// Shows answers: as buttons with numbers, which are also keys, or if there are many, as a line with a mark.
import {by_id, make, show_only_if} from "../../../net/page/dom.js";
import {make_drawing} from "./drawing.js";
import {draw_picture} from "./motion.js";
import {fits_entry} from "./entry.js";

const MOST_BUTTONS = 11; // greatest number of steps that a scale shows as buttons

function has_words_at_ends(choices) {
  return choices.length > 2 && choices[0] && choices.slice(1, -1).every(c => !c);
}
function find_kind({screen, choices, pictures, are_stimuli}) {
  if (pictures) return "pictures";
  if (choices.length === 1) return "begin";
  if (screen === "questionnaire" && choices.every(c => c)) return "list";
  if (screen === "consent" || screen === "walk") return "plain";
  if (choices.length === 2 || are_stimuli) return "pair";
  if (choices.length > MOST_BUTTONS) return "line";
  return has_words_at_ends(choices) || choices.every(c => !c) ? "scale" : "list";
}
function make_button(s, label, i, tactors) {
  const kind = find_kind(s), b = make("button", {type: "button"});
  if (kind === "pictures") b.append(draw_picture(tactors, s.pictures[i]));
  if (kind !== "begin") b.append(make("b", {}, i + 1));
  if (label && kind === "scale") b.setAttribute("aria-label", `${i + 1}, ${label}`);
  else if (label) b.append(make("span", {}, label));
  return b;
}

// Makes a line whose mark appears when it is set, and a button that answers. Only the steps of a scale have numbers.
function make_line({choices, visual}, word, answer) {
  const describe = i => [...visual ? [] : [i + 1], choices[i]].join(" ").trim();
  const number = make("output"), confirm = make("button", {type: "button", onclick: () => answer(mark.valueAsNumber)}, word);
  const set = () => {
    by_id("answers").classList.remove("unset");
    confirm.disabled = mark.disabled;
    if (!visual) number.textContent = describe(mark.value - 1);
    mark.setAttribute("aria-valuetext", visual ? mark.value - 1 : number.textContent);
  };
  // Safari only lets people drag the mark, which is hidden at first. Here a press anywhere on the line sets it.
  const point = e => {
    const {x, width} = mark.getBoundingClientRect();
    mark.style.setProperty("--at", e.buttons || e.pointerType !== "mouse" || mark.disabled ? "-20px" : `${e.clientX - x - 4}px`);
    if (!e.buttons || mark.disabled) return;
    mark.value = 1 + (choices.length - 1) * (e.clientX - x) / width;
    set();
  };
  const mark = make("input", {type: "range", min: 1, max: choices.length, "aria-labelledby": "question low high", "aria-valuetext": "–",
    oninput: set, onpointerdown: point, onpointermove: point, onpointerleave: () => mark.style.removeProperty("--at"), onkeydown: e => { if (e.key === "Enter" && !e.repeat) confirm.click(); }});
  return [mark, make("span", {id: "low"}, describe(0)), make("span", {id: "high"}, describe(choices.length - 1)), number, confirm];
}

// Makes a field for a number, with its range, or for a text, and a button that answers.
function make_entry(entry, words, answer) {
  const {greatest, lowest, longest, most} = entry;
  const confirm = make("button", {type: "button", onclick: () => answer(most || longest ? place.value : Number(place.value))}, words.confirm);
  const look = () => { // leaves the text as typed: 1.5 and 1e5 must not become 15
    const fits = fits_entry(place.value, entry);
    by_id("answers").classList.toggle("unset", !fits);
    place.setAttribute("aria-invalid", place.value !== "" && !fits);
    confirm.disabled = place.disabled || !fits;
  };
  // The numeric keyboard has no point in locales with a decimal comma.
  const keyboard = !longest ? "numeric" : (0.5).toLocaleString().includes(".") ? "decimal" : "text";
  const place = most ? make("textarea", {rows: 5, maxlength: most, "aria-labelledby": "question"})
    : make("input", {inputmode: keyboard, autocomplete: "off", "aria-labelledby": "question range", oninput: look,
      onkeydown: e => { if (e.key === "Enter" && !e.repeat) confirm.click(); }});
  return [place, ...most ? [] : [make("span", {id: "range"}, longest ? words.any_number : `${lowest}–${greatest}`)], confirm];
}

let kept = ""; // content of the answers shown, as JSON
let focused = -1;

// Shows the answers of a screen. Keeps the buttons and the focus if the question is the same.
export function show_answers(s, facts, words, answer) {
  const choices = s.choices ?? [], all = by_id("answers"), now = JSON.stringify([choices, s.pictures, s.screen, s.entry, s.question,
    s.screen === "questionnaire" && s.progress]); // the next item may look the same
  const kind = choices.length ? find_kind(s) : s.entry?.draw ? "drawing" : s.entry ? "entry" : "", on_line = kind === "line";
  if (now !== kept || !kind) {
    kept = now;
    all.closest("main").scrollTop = 0;
    focused = on_line || s.entry ? 0 : -1; // so that arrows set the mark, and keys type
    all.className = on_line || s.entry && (s.entry.draw || !s.entry.most) ? `${kind} unset` : kind;
    const set = (name, value) => all.style.setProperty(name, value), n = choices.length;
    const on_phone = n < 5 && n !== 3 ? 2 : 3;
    set("--n", n);
    set("--across-wide", n < 5 ? n : Math.ceil(n / 2));
    set("--across-phone", on_phone);
    all.classList.toggle("long", n > 7);
    all.classList.toggle("slim", on_phone > 2);
    all.replaceChildren(...on_line ? make_line(s, words.confirm, answer) : kind === "drawing" ? make_drawing(s.entry, facts, words, answer)
      : s.entry ? make_entry(s.entry, words, answer) : choices.map((label, i) => {
      const b = make_button(s, label, i, facts.tactors);
      b.addEventListener("click", () => answer(i + 1));
      return b;
    }));
  }
  for (const b of all.children) b.classList.remove("chosen");
  const ends = kind === "scale" && has_words_at_ends(choices);
  show_only_if(by_id("ends"), ends);
  if (ends) [by_id("ends").firstElementChild.textContent, by_id("ends").lastElementChild.textContent] = [choices[0], choices.at(-1)];
}
export function enable_answers(yes) {
  const all = [...by_id("answers").children];
  if (!yes && all.includes(document.activeElement)) focused = all.indexOf(document.activeElement);
  for (const b of all) {
    b.disabled = !yes || b.matches(".unset button");
    b.classList.toggle("closed", !yes); // an SVG cannot be disabled
  }
  if (yes && focused >= 0) {
    all[focused]?.focus();
    focused = -1;
  }
}
export function mark_answer(choice) {
  const buttons = by_id("answers").querySelectorAll("button");
  (buttons[choice - 1] ?? buttons[0]).classList.add("chosen"); // a line has only one button
}

// Shows the stimuli of a trial where their answers will be, and highlights the one that plays.
export function show_stimuli(count, playing, names = []) {
  const all = by_id("stimuli");
  show_only_if(all, count > 0);
  by_id("playing").textContent = playing ? [playing, names[playing - 1]].join(" ").trim() : "";
  if (all.children.length !== count)
    all.replaceChildren(...Array.from({length: count}, (_, i) => make("div", {}, make("b", {}, i + 1), names[i] && make("span", {}, names[i]))));
  [...all.children].forEach((e, i) => e.classList.toggle("on", i + 1 === playing));
}
