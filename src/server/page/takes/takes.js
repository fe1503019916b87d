// SPDX-License-Identifier: MIT
// Takes: {id, name, origin, strokes, options}. They are values: a change makes a new one, so that all can be undone.
import {state, changed, current_take, level_dbfs, say} from "../state.js";
import {open_storage} from "./storage.js";
import {total_s, strokes_toml, fitted, editable} from "./stroke.js";

const done = [], undone = [];
let storage = null, number = 0;

export async function open_takes() {
  storage = await open_storage("tactor");
  const kept = await storage.load();
  const mine = state.takes;                      // drawn before the storage was open
  state.takes = [...kept.takes.sort((a, b) => b.made - a.made), ...mine];
  state.current = kept.current ?? state.takes[0]?.id ?? null;
  state.storage_lasts = storage.lasting !== false;
  number = state.takes.reduce((most, t) => Math.max(most, Number(/^Take (\d+)$/.exec(t.name)?.[1] ?? 0)), 0);
  changed("takes", "take");
}

const snapshot = () => ({takes: state.takes, current: state.current, stroke: state.stroke});

// Takes over new lists, and writes down what differs from before.
function put(next) {
  const before = new Map(state.takes.map(t => [t.id, t]));
  Object.assign(state, next);
  for (const t of state.takes) {
    if (before.get(t.id) !== t) keep(s => s.save(t));
    before.delete(t.id);
  }
  for (const id of before.keys()) keep(s => s.remove(id));
  keep(s => s.set("current", state.current));
  state.stroke = Math.min(state.stroke, Math.max(0, (current_take()?.strokes.length ?? 1) - 1));
  changed("takes", "take");
}
let told = false;
function keep(f) {
  Promise.resolve().then(() => storage && f(storage)).catch(() => {
    if (!told) say("The browser keeps no more takes; save what you need as a file");
    told = true;
  });
}
// The edits of one drag are one step: `same` names it.
let last_same = null;
export function edit(next, same = null) {
  if (!same || same !== last_same) done.push(snapshot());
  last_same = same;
  undone.length = 0;
  put(next);
}
export const end_edit = () => { last_same = null; };
export const can_undo = () => done.length > 0;
export const can_redo = () => undone.length > 0;
export function undo() { step(done, undone); }
export function redo() { step(undone, done); }
function step(from, to) {
  if (!from.length) return;
  last_same = null;
  to.push(snapshot());
  put(from.pop());
}

const new_id = () => `${Date.now().toString(36)}-${Math.floor(Math.random() * 1e9).toString(36)}`;

export function add_take(strokes, {name, origin, options} = {}) {
  const take = {id: new_id(), made: Date.now(), name: name || `Take ${++number}`, origin: origin ?? "drawn", strokes,
    options: options ?? current_take()?.options ?? {}};
  edit({takes: [take, ...state.takes], current: take.id, stroke: 0});
  return take;
}
function replace_take(take, same) {
  edit({takes: state.takes.map(t => t.id === take.id ? take : t), current: take.id}, same);
}
export function edit_take(change, same) {
  const take = current_take();
  if (take) replace_take({...take, ...change(take)}, same);
}
// Changes a stroke as it is, or once it can be edited by points.
export function put_stroke(change, same, index = state.stroke) {
  edit_take(t => ({strokes: t.strokes.map((s, i) => i === index ? change(s) : s)}), same);
}
export const edit_stroke = (change, same) => put_stroke(s => change(editable(s)), same);
export function set_option(name, value, same = `option ${name}`) {
  const take = current_take() ?? add_take([], {name: "Settings"});
  const options = {...take.options};
  if (value === undefined || value === null) delete options[name]; else options[name] = value;
  replace_take({...take, options}, same);
}
export function choose_take(id) {
  if (id === state.current) return;
  Object.assign(state, {current: id, stroke: 0, knot: -1, append: false, at_s: 0});
  last_same = null;
  keep(s => s.set("current", id));
  changed("takes", "take");
}
export function rename_take(id, name) {
  const take = state.takes.find(t => t.id === id);
  if (take && name.trim()) edit({takes: state.takes.map(t => t.id === id ? {...t, name: name.trim().slice(0, 60)} : t)});
}
export function duplicate_take(id) {
  const take = state.takes.find(t => t.id === id), at = state.takes.indexOf(take);
  const copy = {...take, id: new_id(), made: Date.now(), name: `${take.name}, copy`};
  edit({takes: [...state.takes.slice(0, at), copy, ...state.takes.slice(at)], current: copy.id});
}
export function delete_take(id) {
  const at = state.takes.findIndex(t => t.id === id), take = state.takes[at];
  const takes = state.takes.filter(t => t.id !== id);
  edit({takes, current: id === state.current ? takes[Math.min(at, takes.length - 1)]?.id ?? null : state.current, stroke: 0});
  say(`Deleted “${take.name}”; Ctrl Z brings it back`);
}
export function fit_take(edge) {
  edit_take(t => ({strokes: fitted(t.strokes, edge)}));
  say("Fitted; Ctrl Z takes it back");
}
export const take_s = t => t ? total_s(t.strokes) : 0;

// Makes what the service plays, plans and writes: the same for all three.
export const make_request = take => ({toml: strokes_toml(take.strokes), options: request_options(take, level_dbfs())});
export function request_options(take, dbfs) {
  const o = {outside: "clamp", ...take?.options};
  if (o.sl === undefined) o.level_dbfs = dbfs;
  return o;
}
// Returns the strokes of an answer to import.
export const imported_strokes = r => r.points.map((timed, i) => ({name: r.strokes[i].name, start_s: r.strokes[i].start_s, timed}));
