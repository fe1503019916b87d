// SPDX-License-Identifier: MIT
// The tour: six steps on a card beside the array, each with something to try.
import {state, changed, is_simulated} from "../state.js";
import {by_id, make, listen} from "../../../net/page/dom.js";
import {array} from "../drawing/view.js";
import {choose_take} from "./takes.js";
import {path, resting, at_law, taps, middle_pair, try_entry, ROW} from "./gallery.js";

// Title, text, what its strokes go over (see the gallery), and [name, strokes] of what is tried, with the neighbours a and b.
const tour = ([a, b], feel) => [
  ["One tactor", `Tactor ${b} buzzes where it is.`, 0, ["Tap it", [[0, resting(1, 0.5)]]]],
  ["A point where nothing is", `Now ${a} and ${b} play together, equally strong. You ${feel} one point between them: a phantom.`, 0,
    ...[["Again", 0.5], [`Only ${a}`, 0], [`Only ${b}`, 1]].map(([name, u]) => [name, [[0, resting(u, 1)]]])],
  ["It moves", `The strength goes over from ${a} to ${b} while both play, and the point wanders along.`, 0,
    ...[["Again", 1.2], ["Slower", 3.6]].map(([name, s]) => [name, [[0, path(s, ROW)]]])],
  ["From taps to a stroke", "Ten short bursts along a line. Make the interval shorter until they become a stroke.", 1,
    ...[400, 200, 70].map(ms => [`${ms} ms`, [[0, path(0.009 * ms + 0.001, ROW), taps(ms / 1000)]]])],
  ["Park’s law", "A burst of 70 ms wants 0.32 × 70 + 47 = 69 ms until the next. Shorter blurs; longer breaks into taps.", 1,
    ...[["0.6 of it", 0.6], ["The law", 1], ["1.6 of it", 1.6]].map(([name, part]) => [name, at_law(path(1.6, ROW), part)])],
  ["Your turn", `Draw on the array. You ${feel} it while you draw, and it is kept as a take.`]];

const card = by_id("p-tour"), gallery = by_id("p-gallery");
// Shows a step. One that can be tried again begins by itself.
function show_step(n) {
  const steps = tour(middle_pair().map(i => array.tactors[i].tactor ?? i), is_simulated() ? "hear" : "feel");
  const [title, text, over, ...tried] = steps[n], next = steps[n + 1];
  const button = (name, onclick, disabled) => make("button", {class: "button outlined", onclick, disabled}, name);
  const actions = tried.map(([name, strokes]) => [name,
    () => try_entry([title, "", over, strokes, over ? {} : {algorithm: "continuous"}, -6 * over])]);
  if (!next) actions.push(["Draw", leave_tour], ["See the gallery", () => { leave_tour(); gallery.showPopover(); }]);
  card.replaceChildren(make("h2", {}, title), make("p", {}, text), make("div", {class: "row"}, ...actions.map(a => button(...a))),
    make("div", {class: "row"}, button("Leave", leave_tour), make("small", {class: "space"}, `${n + 1} of 6`),
      button("Back", () => show_step(n - 1), !n), button("Next", () => show_step(n + 1), !next)));
  card.lastChild.lastChild.focus();
  if (actions[0][0] === "Again") actions[0][1]();
}
listen(card, "toggle", () => changed("layout"));
export function open_tour() {
  gallery.hidePopover();
  card.showPopover();
  show_step(0);
}
function leave_tour() {
  card.hidePopover();
  if (state.trial?.id === state.current) choose_take(state.takes[0]?.id ?? null);
}
