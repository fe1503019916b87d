// SPDX-License-Identifier: MIT
// Takes: {id, version, name, origin, strokes, options}. They are values: a change makes a new take with a new version,
// so that it can be undone.
import {state, changed, current_take, level_dbfs, say, LEAST_PART_S} from "../state.js";
import {put_takes, keep_current, find_take, all_takes, new_id} from "./keeping.js";
import {total_s, duration_s, trimmed, fitted, editable} from "./stroke.js";
import {strokes_toml} from "./stroke_file.js";

const MOST_STEPS = 300, MOST_UNDO_BYTES = 8 << 20; // limits of undo
const ROW_BYTES = 40;         // memory of a row of points

// Steps: {changes: [[id, take before, take after], ...], current: [before, after], stroke}.
let done = [], undone = [];

export const steps_of_undo = () => ({done, undone});
export function restore_undo(steps) {
  done = [...steps.done, ...done];
  undone = steps.undone;
}
// Drops the oldest steps. Data that they share with later steps is not counted.
function bound_undo() {
  const seen = new Set();
  let bytes = 0, i = done.length;
  for (; i > 0 && done.length - i < MOST_STEPS && bytes < MOST_UNDO_BYTES; --i)
    for (const s of done[i - 1].changes.flatMap(([, before, after]) => [...before?.strokes ?? [], ...after?.strokes ?? []]))
      for (const rows of [s.timed, s.base, s.ink, s.knots]) if (rows && !seen.has(rows)) { seen.add(rows); bytes += ROW_BYTES * rows.length; }
  done = done.slice(i);
}
// Changes takes. The edits of one drag are one step: `same` names it.
let last_same = null;
function edit(takes, {current = state.current, stroke = state.stroke, same = null} = {}) {
  const changes = takes.map(t => [t.id, find_take(t.id) ?? null, {...t, version: new_id()}]);
  if (same && same === last_same) done.at(-1).changes.forEach((c, i) => { c[2] = changes[i][2]; });
  else done.push({changes, current: [state.current, current], stroke: state.stroke});
  last_same = same;
  undone = [];
  bound_undo();
  state.stroke = stroke;
  put_takes(changes.map(([id,, take]) => [id, take]), current);
}
export const end_edit = () => { last_same = null; };
export const can_undo = () => done.length > 0;
export const can_redo = () => undone.length > 0;
export function undo() { step(done, undone); }
export function redo() { step(undone, done); }
function step(from, to) {
  const s = from.pop();
  if (!s) return;
  last_same = null;
  const other = s.changes.find(([id,, after]) => find_take(id)?.version !== after?.version || !find_take(id) !== !after);
  if (other) {
    say(`“${(other[2] ?? other[1]).name}” has changed in another tab; the page keeps that change`);
    return changed("take");
  }
  to.push({changes: s.changes.map(([id, before, after]) => [id, after, before]), current: [s.current[1], s.current[0]], stroke: state.stroke});
  state.stroke = s.stroke;
  put_takes(s.changes.map(([id, before]) => [id, before]), s.current[0]);
}

export function add_take(strokes, {name, origin, options, ...more} = {}) {
  const number = 1 + all_takes().reduce((most, t) => Math.max(most, Number(/^Take (\d+)$/.exec(t.name)?.[1] ?? 0)), 0);
  const take = {...more, id: new_id(), made: Date.now(), name: name || `Take ${number}`, origin: origin ?? "drawn", strokes,
    options: options ?? current_take()?.options ?? {}};
  edit([take], {current: take.id, stroke: 0});
  return take;
}
// Replaces a take, shown or not.
export const put_take = (take, same) => edit([take], {same});
export function edit_take(change, same) {
  const take = current_take();
  if (take) edit([{...take, ...change(take)}], {same});
}
// Changes a stroke, after making it editable if necessary.
export function put_stroke(change, same, index = state.stroke) {
  edit_take(t => ({strokes: t.strokes.map((s, i) => i === index ? change(s) : s)}), same);
}
export const edit_stroke = (change, same) => put_stroke(s => change(editable(s)), same);
// Returns a take as played by a side of a comparison (0: the take itself; default: the sounding side).
// A card that is held is over both.
export const with_side = (take, side = state.compare?.on) => take && (side || state.tried)
  ? {...take, options: {...take.options, ...side && state.compare.other, ...state.tried}} : take;
// Options of the take, and their rows in the table.
export const row = name => state.options.find(o => o.name === name);
export const value = name => with_side(current_take())?.options[name] ?? row(name)?.default ?? null;
export const algorithm = () => value("algorithm") ?? "park2016";
export function set_option(name, v, same = `option ${name}`) {
  if (state.compare?.on) {
    state.compare.other = {...state.compare.other, [name]: v ?? undefined};
    return changed("take");
  }
  const take = current_take() ?? add_take([], {name: "Settings"});
  const options = {...take.options};
  if (v === null) delete options[name]; else options[name] = v;
  edit([{...take, options}], {same});
}
export function choose_take(id) {
  if (id === state.current) return;
  Object.assign(state, {current: id, stroke: 0, knot: -1, append: false, at_s: 0});
  last_same = null;
  keep_current();
  changed("takes", "take");
}
// Shows strokes to try, which become a take with the first change.
export function try_take(take) {
  state.trial = {id: new_id(), made: Date.now(), options: {}, ...take};
  choose_take(state.trial.id);
}
export function rename_take(id, name) {
  const take = find_take(id);
  if (take && name.trim()) edit([{...take, name: name.trim().slice(0, 60)}]);
}
export function duplicate_take(id) {
  const take = find_take(id), copy = {...take, id: new_id(), made: take.made + 0.001, name: `${take.name}, copy`};
  edit([copy], {current: copy.id});
}
export function delete_take(id) {
  const take = find_take(id);
  edit([{...take, deleted: Date.now()}], {stroke: id === state.current ? 0 : state.stroke});
  say(`Deleted “${take.name}”`, () => bring_back(id));
}
export function bring_back(id) {
  const {deleted: _, ...take} = find_take(id);
  edit([take], {current: id, stroke: 0});
}
export function fit_take(edge) {
  edit_take(t => ({strokes: fitted(t.strokes, edge)}));
  say("Fitted", undo);
}
// Returns the part of a take between two moments; its time begins at the first.
export const take_part = (take, from_s, until_s) => ({...take, strokes: take.strokes.flatMap(k => {
  const d = duration_s(k), a = Math.max(0, from_s - k.start_s), b = Math.min(d, until_s - k.start_s);
  if (b - a < Math.min(LEAST_PART_S, d)) return [];
  return {...a > 0 || b < d ? trimmed(k, a, b) : k, start_s: Math.max(0, k.start_s - from_s)};
})});
export const take_s = t => t ? total_s(t.strokes) : 0;

// Makes the parameters for playing, planning and exporting.
export const make_request = (take, dbfs = level_dbfs()) => ({toml: strokes_toml(take.strokes, take.options), options: request_options(take, dbfs)});
// Returns the options of a request. The take's gain keeps strokes that add up within the level.
export function request_options(take, dbfs) {
  const o = {outside: "clamp", ...take?.options};
  const gain_db = take?.gain_db ?? 0;
  if (o.sl === undefined) o.level_dbfs = dbfs + gain_db; else o.sl += gain_db;
  return o;
}
