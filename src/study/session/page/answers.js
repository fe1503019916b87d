// SPDX-License-Identifier: MIT
// Answers are buttons with numbers, which are keys, too. Their kinds only look different.
import {by_id, make, show_only_if} from "../../../net/page/dom.js";
import {draw_picture} from "./motion.js";

function has_words_at_ends(choices) {
  return choices.length > 2 && choices[0] && choices.slice(1, -1).every(c => !c);
}
function find_kind({screen, choices, pictures}) {
  if (pictures) return "pictures";
  if (choices.length === 1) return "begin";
  if (screen === "consent" || screen === "walk") return "plain";
  if (choices.length === 2) return "pair";
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

let kept = ""; // what the buttons show
let focused = -1;

// Shows the buttons of a screen. Those of the same question stay, with the keyboard's focus.
export function show_answers(s, tactors, answer) {
  const choices = s.choices ?? [], all = by_id("answers"), now = JSON.stringify([choices, s.pictures, s.screen]);
  if (now !== kept || !choices.length) {
    kept = now;
    all.closest("main").scrollTop = 0;
    focused = -1;
    all.className = choices.length ? find_kind(s) : "";
    const set = (name, value) => all.style.setProperty(name, value), n = choices.length;
    const on_phone = n < 5 && n !== 3 ? 2 : 3;
    set("--n", n);
    set("--across-wide", n < 5 ? n : Math.ceil(n / 2));
    set("--across-phone", on_phone);
    all.classList.toggle("long", n > 7);
    all.classList.toggle("slim", on_phone > 2);
    all.replaceChildren(...choices.map((label, i) => {
      const b = make_button(s, label, i, tactors);
      b.addEventListener("click", () => answer(i + 1));
      return b;
    }));
  }
  for (const b of all.children) b.classList.remove("chosen");
  const ends = has_words_at_ends(choices);
  show_only_if(by_id("ends"), ends);
  if (ends) [by_id("ends").firstElementChild.textContent, by_id("ends").lastElementChild.textContent] = [choices[0], choices.at(-1)];
}
export function enable_answers(yes) {
  const all = [...by_id("answers").children];
  if (!yes && all.includes(document.activeElement)) focused = all.indexOf(document.activeElement);
  for (const b of all) b.disabled = !yes;
  if (yes && focused >= 0) {
    all[focused]?.focus();
    focused = -1;
  }
}
export function mark_answer(choice) { by_id("answers").children[choice - 1].classList.add("chosen"); }

// Shows the stimuli of a trial at the places of the answers, and lights the one that plays.
export function show_stimuli(count, playing, names = []) {
  const all = by_id("stimuli");
  show_only_if(all, count > 0);
  by_id("playing").textContent = playing ? [playing, names[playing - 1]].join(" ").trim() : "";
  if (all.children.length !== count)
    all.replaceChildren(...Array.from({length: count}, (_, i) => make("div", {}, make("b", {}, i + 1), names[i] && make("span", {}, names[i]))));
  [...all.children].forEach((e, i) => e.classList.toggle("on", i + 1 === playing));
}
