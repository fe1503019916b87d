// SPDX-License-Identifier: MIT
// Comparison of two methods on one stroke: side 0 is the take itself, side 1 has other options. Both loop in step, and
// one of them is silent.
import {state, changed, on_change, current_take, level_dbfs, say} from "../state.js";
import {by_id, on_click, show_pressed, all_of, listen, set_text} from "../../../net/page/dom.js";
import {row, value, with_side, request_options} from "../takes/takes.js";
import {with_level} from "../takes/stroke_file.js";
import {file_name, give_toml} from "../takes/files.js";
import {study_files, study_command} from "./study.js";
import {play, quit_playing, tell_level, hear_it} from "../service/player.js";
import {ALGORITHMS, PHANTOMS, facts_text, short_facts} from "../words.js";

const LONGEST_WAIT_S = 0.07; // longest wait for the next burst; message and ramp take up to 30 ms more
const LEAD_S = 0.02;         // time before the burst at which the side changes
const FEW = 20;              // number of answers that are too few for a result

export function toggle_compare() {
  if (state.compare) return close_compare();
  if (!current_take()?.strokes.length) return say("Draw or choose a take to compare");
  quit_playing();
  // order: the side of each card; rest: the plan of the side that is silent.
  state.compare = {take: state.current, on: 0, order: [0, 1], blind: false, heard: new Set(), answers: [], rest: null, looped: state.loop,
    other: value("algorithm") === "park2016" ? {algorithm: "tactile-brush", snap: true} : {algorithm: "park2016"}};
  state.loop = true;
  delete document.body.dataset.sheetOpen;
  changed("take", "layout");
  play();
}
export function close_compare() {
  quit_playing();
  clearTimeout(state.compare.timer);
  Object.assign(state, {compare: null, loop: state.compare.looped});
  tell_level();
  changed("take", "layout");
}
const plan_of_side = side => side === state.compare.on ? state.plan : state.compare.rest;
// Switches to the side of a card with the next burst, at the same moment of the stroke.
export function choose_side(card) {
  const c = state.compare, side = c?.order[card];
  if (!c) return;
  const next = (plan_of_side(side)?.onsets ?? []).reduce((t, v) => v > state.at_s + LEAD_S ? Math.min(t, v) : t, Infinity);
  const played = state.playing !== null;
  clearTimeout(c.timer);
  c.timer = setTimeout(() => {
    if (c.on !== side) [state.plan, c.rest] = [c.rest, state.plan];
    c.on = side;
    c.heard.add(card);
    tell_level();
    if (!played) play(); else if (state.playing) hear_it(); // unless it was stopped meanwhile
    changed("take", "plan");
  }, played ? 1000 * Math.min(LONGEST_WAIT_S, next - state.at_s - LEAD_S) : 0);
}
// Shuffles the cards, which must be heard again.
function ask_again() {
  state.compare.order = Math.random() < 0.5 ? [0, 1] : [1, 0];
  state.compare.heard.clear();
  choose_side(0);
}
on_click("blind", () => {
  const c = state.compare;
  c.blind = !c.blind;
  if (c.blind) { c.answers = []; ask_again(); } else c.order = [0, 1];
  changed("take");
});
// Returns the number of times that each side was chosen; after a reveal, with the sides' names.
function tally_text({answers, blind}) {
  const n = answers.length, often = [0, 1].map(side => answers.filter(v => v === side).length), most = Math.max(...often);
  const who = blind || often[0] === often[1] ? "the same one" : side_name(often.indexOf(most));
  return !n ? blind ? "Which one?" : "" : `${most} of ${n} for ${who}${n < FEW ? "; too few for a result" : ""}`;
}
function side_name(side) {
  const word = (words, name) => words[with_side(current_take(), side).options[name] ?? row(name)?.default]?.[0];
  return `${word(ALGORITHMS, "algorithm")}, ${word(PHANTOMS, "phantom")}`;
}
const side_facts = e => e ? short_facts(e) || "not predicted" : "not possible";

const side_cards = all_of(".side"), votes = by_id("votes");
side_cards.forEach((b, card) => listen(b, "click", () => choose_side(card)));
votes.childNodes.forEach((b, card) => listen(b, "click", () => {
  state.compare.answers.push(state.compare.order[card]);
  ask_again();
}));
on_click("compare-end", close_compare);
on_change(() => {
  const c = state.compare, blind = c?.blind ?? false;
  // Drawing ends a comparison.
  if (c && (c.take !== state.current || state.drawing)) return close_compare();
  by_id("compare").hidden = !c;
  document.body.toggleAttribute("data-blind", blind);
  if (!c) return;
  side_cards.forEach((b, card) => {
    show_pressed(b, c.order[card] === c.on);
    b.childNodes[1].textContent = blind ? "hidden" : side_name(card);
    const errors = plan_of_side(card)?.errors;
    b.childNodes[2].textContent = blind ? "" : side_facts(errors);
    b.title = blind ? "" : facts_text(errors);
  });
  votes.hidden = !blind;
  votes.childNodes.forEach(b => { b.disabled = c.heard.size < 2; });
  by_id("study-open").hidden = blind;
  set_text("blind", blind ? "Reveal" : "Blind");
  set_text("tally", tally_text(c));
});

// Saving a study of both sides. Its definition names the files of the array and the strokes, which lie in the same folder.
const form = by_id("study"), study_name = () => file_name({name: form.elements.name.value});
const show_command = () => { set_text("study-command", study_command(study_name(), state.hello?.stream.pcm)); };
listen("p-study", "beforetoggle", show_command);
listen(form, "input", show_command);
listen(form, "submit", e => {
  e.preventDefault();
  const {question, trials} = form.elements, take = with_level(current_take()), usual = {algorithm: row("algorithm")?.default, phantom: row("phantom")?.default};
  const methods = [0, 1].map(side => ({...usual, ...request_options(with_side(take, side))}));
  study_files({name: study_name(), question: question.value, trials: Math.round(trials.value) || 20, level_dbfs: level_dbfs(),
    array: state.hello.array, take, methods}).forEach(file => give_toml(...file));
});
