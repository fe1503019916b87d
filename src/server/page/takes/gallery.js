// SPDX-License-Identifier: MIT
// The gallery: strokes to try, made for the array. A tap plays one; the first change makes it a take. The tour: six
// steps on a card next to the array, each with a stroke to try.
import {state, changed, on_change, is_simulated} from "../state.js";
import {by_id, make, listen} from "../../../net/page/dom.js";
import {array} from "../drawing/view.js";
import {play} from "../service/player.js";
import {add_take, choose_take, try_take} from "./takes.js";
import {thumb, draw_thumb, facts} from "./takes_panel.js";
import {parts_reached, trimmed} from "./stroke.js";
import {box, distance, outside_mm, sampled} from "../geometry.js";

const BURST_S = 0.07; // by Park's law the interval is the same

// Returns rows of a stroke, [t_s, u, v, strength], along places at one speed. u and v go from 0 to 1.
function path(seconds, places) {
  const rows = places.map((p, i) => [i, ...p, 1]);
  return rows.map(([i, ...q]) => [seconds * parts_reached(rows)[i][0], ...q]);
}
const resting = (u, seconds, v = 0.5, strength = 1) => [[0, u, v, strength], [seconds, u, v, strength]];
const curve = (f, n = 60) => sampled(n, f);
const wave = turns => Math.sin(2 * Math.PI * turns);
const ring = (turn, radius = 0.5) => [0.5 + radius * wave(turn), 0.5 - radius * wave(turn + 0.25)]; // clockwise from the top
// Returns strokes, [start_s, rows, keys].
const one = (...of) => [[0, path(...of)]];
const in_turn = (step_s, list) => list.map((rows, i) => [step_s * i, rows]);
const taps = soa_s => ({soa_s, burst_s: BURST_S});
// Returns bursts at a part of the law's interval. Overlapping ones become two strokes, whose bursts alternate.
function at_law(rows, part, start_s = 0) {
  const step_s = part * BURST_S, keys = taps(part < 1 ? 2 * step_s : step_s), own = [start_s, rows, keys];
  return part < 1 ? [own, [start_s + step_s, trimmed({timed: rows}, step_s, rows.at(-1)[0]).timed, keys]] : [own];
}
const ROW = [[0, 0.5], [1, 0.5]];
const BACK = [...ROW, ROW[0]], PARTS = [0, 0.5, 1], CONTINUOUS = {algorithm: "continuous"}, SHORT = {soa: 0.05, burst: 0.03};

// Entries: name, purpose, range of u and v (0: two neighbours; the array, 1: of two tactors, 2: of three, 3: of two rows, or more; 4: a square in
// two rows), strokes, options, and gain.
const GALLERY = [
  ["Line across", "One line at one speed: the plainest motion.", 1, one(1.2, ROW)],
  ["Fast and slow", "In 0.4 s and in 1.6 s: speed is felt, too.", 2, [[0, path(0.4, ROW)], [0.8, path(1.6, ROW)]]],
  ["Half circle", "A curve that three tactors at a time make.", 4, one(1.4, curve(p => ring(-p / 2)))],
  ["Three-quarter circle", "Where does it begin, and which way does it turn?", 4, one(2.1, curve(p => ring(0.5 + 0.75 * p)))],
  ["Nothing there", "Two tactors, felt as one point between them.", 0, [[0, resting(0.5, 1)]], CONTINUOUS],
  ["Between two", "The point moves to a neighbour and back.", 0, one(1.6, BACK), CONTINUOUS],
  ["Taps to motion", "Taps at 400 ms, a stroke at 70.", 1, [0.4, 0.2, 0.13, 0.1, 0.07].map((s, i) => [1.6 * i, path(1.2, ROW), taps(s)])],
  ["Three laws", "0.6, 1 and 1.6 of Park’s law: blurs, flows, breaks up.", 4,
    [0.6, 1, 1.6].flatMap((part, i) => at_law(path(1.6, curve(p => ring(p))), part, 2 * i)), {}, -6],
  ["Rabbit", "Three taps in three places, felt between them, too.", 2, in_turn(0.15, PARTS.map(u => resting(u, 0.12))), SHORT],
  ["Brush", "Three soft passes, strong in the middle.", 3, in_turn(1.3, PARTS.map(v => PARTS.map(p => [p, p, v, p === 0.5 ? 1 : 0.3])))],
  ["Rain", "Twenty-four short drops, never two in one place.", 2,
    curve(p => [3.4 * p + 0.05 * wave(9 * p), resting((161 * p % 24) / 24, 0.03, 14.2 * p % 1)], 23), SHORT],
  ["Heartbeat", "Two beats, then a rest. Loop it.", 1,
    [[0, resting(0.5, 0.08)], [0.18, resting(0.5, 0.08)], [0.3, resting(0.5, 0.7, 0.5, 0)]], CONTINUOUS],
  ["Breath", "It swells to the edge in 4 s, and draws back in 6.", 2,
    [[0, 4, 0], [4.1, 6, 1]].map(([start, s, from]) => [start, curve(p => [s * p, ...ring(5 * p, Math.abs(from - p) / 2), 1], 200)])],
  ["Spiral in", "Three turns to the centre.", 4, one(4, curve(p => ring(3 * p, (1 - p) / 2), 150))],
  ["Figure of eight", "It crosses itself.", 3, one(2.4, curve(p => [0.5 + wave(p) / 2, 0.5 + 0.4 * wave(2 * p)]))],
  ["Zigzag", "Are its corners felt as corners, or as bends?", 3, one(1.8, curve(p => [6 * p % 2 > 0.5 ? 1 : 0, p], 6))],
  ["Compass", "Up, right, down, left.", 3, in_turn(0.8, [0, 0.25, 0.5, 0.75].map(turn => path(0.5, [[0.5, 0.5], ring(turn)])))],
  ["Letter S", "As it is written on the skin.", 3, one(2.6, curve(p => [0.5 + wave(1.5 * p - 0.75) / 2, p]))],
  ["Sandpaper", "Noise, 30 grains a second.", 1, one(2, BACK), {...CONTINUOUS, waveform: "noise:60-400", am: "30"}],
  ["Two fingers", "Together, apart, together.", 3,
    [1, -1].map(sign => [0, path(2.4, curve(p => [p, 0.5 + sign * wave(p / 2) ** 2 / 2]))]), {}, -6]];

// Returns two neighbours near the middle of the array; the second one is nearer, and a horizontal pair wins over a vertical one.
function middle_pair() {
  const {places, box: {middle}} = array;
  return places.flatMap((p, i) => places.map((q, k) => [i, k, i === k ? Infinity : distance(p, q) + distance(p, middle) + 1.01 * distance(q, middle)
    + 0.001 * Math.abs(p[1] - q[1])])).sort((a, b) => a[2] - b[2])[0].slice(0, 2);
}
// Returns strokes scaled to the array without a tenth at each edge; smaller if its hull is narrower than its box.
function on_array(strokes, over) {
  const {edge, places} = array, {size} = array.box, line = over ? edge.length < 3 && edge : middle_pair().map(i => places[i]);
  const {middle} = box(line || places);
  const span = line ? [0, 1].map(k => line[1][k] - line[0][k]) : over > 3 ? [Math.min(...size), Math.min(...size)] : size;
  for (let part = over ? 0.8 : 1; ; part *= 0.95) {
    const at = (w, k) => +(middle[k] + span[k] * part * (w[line ? 0 : k] - 0.5)).toFixed(3);
    const made = strokes.map(([start_s, rows, keys], i) => ({name: `stroke ${i + 1}`, start_s, keys,
      timed: rows.map(([t, ...w]) => [+t.toFixed(4), at(w, 0), at(w, 1), w[2]])}));
    if (made.every(s => s.timed.every(([, ...q]) => outside_mm(edge, q) < 0.1))) return made;
  }
}
const as_take = ([name,, over, made, options = {}, gain_db]) =>
  ({name, origin: "one stroke", strokes: on_array(made, over), options, gain_db});
let example = GALLERY[0];
export const open_example = () => { const take = as_take(example); add_take(take.strokes, take); };
let tried = null; // the thumb of the card that was tapped last
export const try_entry = (entry = example, picture = null) => { tried = picture; try_take(as_take(entry)); play(); };

on_change(() => {
  if (!array) return;
  const allows = array.edge.length > 2 ? 4 : array.places.length > 2 ? 2 : 1;
  example = GALLERY[allows > 2 ? 3 : 0];
  const entry = (g, kind, onclick) => {
    const take = as_take(g), disabled = g[2] > allows;
    return make("li", {}, make("button", {class: `take ${kind}`, disabled, onclick}, thumb(take.strokes), make("span", {},
      make("b", {}, g[0]), make("small", {}, disabled ? "needs two rows" : facts(take))), kind && make("p", {}, g[1])));
  };
  by_id("strokes").replaceChildren(...GALLERY.map(g => entry(g, "card", e => try_entry(g, e.currentTarget.firstChild))));
  by_id("examples").replaceChildren(entry(example, "", open_example));
}, "array");
// Animates the card whose stroke plays; called once a frame.
let shown = null;
export function draw_card() {
  const now = state.trial && state.playing?.take === state.trial.id ? tried : null;
  if (shown !== now) {
    shown?.draw();
    for (const c of [shown, now]) c?.parentElement.toggleAttribute("data-playing", c === now);
  }
  shown = now;
  if (now) draw_thumb(now, state.trial.strokes, state.at_s);
}

// Steps of the tour: title, text, range of its strokes (as in the gallery), and [name, strokes] to try, with the neighbours a and b.
const tour = ([a, b], feel) => [
  ["One tactor", `Tactor ${b} buzzes where it is.`, 0, ["Tap it", [[0, resting(1, 0.5)]]]],
  ["A point without a tactor", `Now ${a} and ${b} play together, equally strong. You ${feel} one point between them: a phantom.`, 0,
    ...[["Again", 0.5], [`Only ${a}`, 0], [`Only ${b}`, 1]].map(([name, u]) => [name, [[0, resting(u, 1)]]])],
  ["It moves", `The strength moves from ${a} to ${b} while both play, and the point moves with it.`, 0,
    ...[["Again", 1.2], ["Slower", 3.6]].map(([name, s]) => [name, [[0, path(s, ROW)]]])],
  ["From taps to a stroke", "Ten short bursts along a line. Make the interval shorter until they become a stroke.", 1,
    ...[400, 200, 70].map(ms => [`${ms} ms`, [[0, path(0.009 * ms + 0.001, ROW), taps(ms / 1000)]]])],
  ["Park’s law", "After the onset of a 70 ms burst, the next one should begin 0.32 × 70 + 47 = 69 ms later. Earlier, the stroke blurs; later, it breaks into taps.", 1,
    ...[["0.6 of it", 0.6], ["The law", 1], ["1.6 of it", 1.6]].map(([name, part]) => [name, at_law(path(1.6, ROW), part)])],
  ["Your turn", `Draw on the array. You ${feel} it while you draw, and the page keeps it as a take.`]];

const card = by_id("p-tour"), gallery = by_id("p-gallery");
// Shows a step. A step that can be tried begins by itself.
function show_step(n) {
  const steps = tour(middle_pair(), is_simulated() ? "hear" : "feel");
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
for (const p of [card, gallery]) listen(p, "toggle", () => changed("layout"));
export function open_tour() {
  gallery.hidePopover();
  card.showPopover();
  show_step(0);
}
function leave_tour() {
  card.hidePopover();
  if (state.trial?.id === state.current) choose_take(state.takes[0]?.id ?? null);
}
