// SPDX-License-Identifier: MIT
// Takes in the browser's storage and in other tabs: writes each change, and reports changes that it cannot write.
import {state, changed, say, remember, remembered, take_by_id} from "../state.js";
import {open_storage} from "./storage.js";
import {listen} from "../../../net/page/dom.js";

const AGAIN_MS = 3000;   // time until a failed write is tried again
const HISTORY_MS = 1000; // time after an edit until the steps of undo are written
const SHOWN_MS = 10000;  // time for which a change in another tab is shown
export const BIN_DAYS = 30;
export const DAY_MS = 24 * 3600e3; // a tab counts as closed after this time without a write

let all = [];             // all takes, also those in the bin, newest first
let storage = null, writing = null, undo_steps = {history: () => null, restore: () => {}};
const NEWEST = "newest";  // id that no take has: then the first take is shown
const unwritten = new Map(); // takes that have not been written, by id; null for a removed one
const known = new Map();  // versions in the storage, by id
let current_owed = false, history_timer = 0, tabs = {}; // times of the last write of each tab

export const new_id = () => `${Date.now().toString(36)}-${Math.floor(Math.random() * 1e9).toString(36)}`;
export const find_take = id => all.find(t => t.id === id);
export const all_takes = () => all;

// Shows the takes and the edited one.
function show(takes, current = state.current) {
  all = [...takes.values()].sort((a, b) => b.made - a.made);
  const at = Math.max(0, state.takes.findIndex(t => t.id === current));
  state.takes = all.filter(t => !t.deleted);
  state.bin = all.filter(t => t.deleted);
  // Shows the take that came after a removed one.
  const found = current && (take_by_id(current) ?? state.takes[Math.min(at, state.takes.length - 1)]);
  Object.assign(state, {current: found?.id ?? null, stroke: Math.min(state.stroke, Math.max(0, (found?.strokes.length ?? 1) - 1))});
  changed("takes", "take");
}
const by_ids = () => new Map(all.map(t => [t.id, t]));
const takes_and_removed = changes => ({takes: [...changes.values()].filter(Boolean), removed: [...changes.keys()].filter(id => !changes.get(id))});

// Applies changes, [[id, take or null], ...], and writes them.
export function put_takes(changes, current) {
  const takes = by_ids();
  for (const [id, take] of changes) {
    unwritten.set(id, take);
    if (take) takes.set(id, take); else takes.delete(id);
  }
  show(takes, current);
  keep_current();
  clearTimeout(history_timer);
  history_timer = setTimeout(() => storage?.write({values: history_values()}).catch(() => {}), HISTORY_MS);
}
export function keep_current() { current_owed = true; write_owed(); }

// Opens the storage, reads it, and calls restore(steps of undo); history() returns the steps to write.
export function open_takes(history, restore) {
  undo_steps = {history, restore};
  return write_owed();
}
async function open() {
  const opened = await open_storage("tactor", storage_lost);
  const kept = await opened.load(), current = await opened.get("current");
  tabs = await opened.get("tabs") ?? {};
  const steps = await opened.get(`history ${tab}`);
  // No await from here on: a drawing that is made meanwhile would be lost.
  const takes = by_ids();
  let late = null;
  // Adds what a page could not write before it was closed.
  for (const [id, take, version] of JSON.parse(remembered("unwritten") || "[]")) {
    if (kept.find(t => t.id === id)?.version === take?.version) continue;
    known.set(id, version ?? undefined);
    unwritten.set(id, take);
    if (!take) continue;
    takes.set(id, take);
    late = id;
  }
  remember("unwritten", "");
  for (const t of kept) {
    if (unwritten.has(t.id)) continue;
    known.set(t.id, t.version);
    if (t.deleted < Date.now() - BIN_DAYS * DAY_MS) unwritten.set(t.id, null); else takes.set(t.id, t);
  }
  if (steps) undo_steps.restore(steps);
  for (const name of Object.keys(tabs)) if (tabs[name] < Date.now() - DAY_MS) {
    opened.write({values: {[`history ${name}`]: undefined}});
    delete tabs[name];
  }
  storage = opened;
  show(takes, state.current ?? late ?? current ?? NEWEST);
}
const tab = (() => {
  const id = new_id();
  try { return sessionStorage.getItem("tactor-tab") ?? (sessionStorage.setItem("tactor-tab", id), id); } catch { return id; }
})();
function history_values() {
  tabs[tab] = Date.now();
  return {tabs, [`history ${tab}`]: undo_steps.history()};
}

// Writes all takes again after the storage was deleted.
function storage_lost() {
  storage = null;
  known.clear();
  all.forEach(t => unwritten.set(t.id, t));
  set_fault("its data were deleted");
  setTimeout(write_owed, 0);
}

// Writes unwritten takes; resolves when that is done or has failed.
function write_owed() {
  return writing ??= write_all().finally(() => {
    writing = null;
    if (unwritten.size && !state.storage_fault) write_owed();
  });
}
async function write_all() {
  try {
    if (!storage) await open();
    while (unwritten.size || current_owed) {
      const batch = new Map(unwritten), {takes, removed} = takes_and_removed(batch);
      current_owed = false;
      const others = await storage.write({takes, removed, values: {current: state.current}}, known);
      const own = takes.filter(t => !others.some(o => o.id === t.id));
      own.forEach(t => known.set(t.id, t.version));
      removed.forEach(id => known.delete(id));
      for (const [id, take] of batch) if (unwritten.get(id) === take) unwritten.delete(id);
      others.forEach(keep_both);
      if (batch.size) channel.postMessage({takes: own, removed});
      if (takes.length && !remembered("asked-to-persist")) {
        remember("asked-to-persist", 1);
        navigator.storage?.persist?.();
      }
    }
    set_fault("");
  } catch (e) {
    if (storage && e.name === "InvalidStateError") return storage_lost();
    set_fault(e.name === "QuotaExceededError" ? "this browser's storage is full" : storage
      ? `this browser's storage says: ${e.message}` : "this browser keeps nothing for this page");
  }
}
setInterval(() => { if (state.storage_fault && unwritten.size) write_owed(); }, AGAIN_MS);
function set_fault(text) {
  const before = state.unkept.size;
  state.storage_fault = text;
  state.unkept = new Set(text ? takes_and_removed(unwritten).takes.map(t => t.id) : []);
  if (before && !state.unkept.size) say(before === 1 ? "Kept again" : `Kept again, all ${before}`);
  if (text || before) changed("takes", "link");
}
// Reports that a take is stored, or the reason why not, once the write has ended.
export async function say_if_kept(take) {
  await write_owed();
  if (!find_take(take.id)?.deleted) say(state.unkept.has(take.id) ? `Not kept: ${state.storage_fault}` : `Kept as “${take.name}”`);
}
// Writes everything at once while the page goes away. The browser may then drop writes to the database, so it also writes to the local storage.
export function write_at_once() {
  if (unwritten.size) remember("unwritten", JSON.stringify([...JSON.parse(remembered("unwritten") || "[]"),
    ...[...unwritten].map(([id, take]) => [id, take, known.get(id)])]));
  storage?.write({...takes_and_removed(unwritten), values: {current: state.current, ...history_values()}}).catch(() => {});
}

// Other tabs.
const channel = new BroadcastChannel("tactor-takes");
listen(channel, "message", ({data}) => {
  const takes = by_ids();
  for (const t of data.takes) {
    if (unwritten.has(t.id)) continue; // writing this tab's own change will find the other one
    known.set(t.id, t.version);
    takes.set(t.id, t);
    state.elsewhere.add(t.id);
    setTimeout(() => { state.elsewhere.delete(t.id); changed("takes"); }, SHOWN_MS);
  }
  for (const id of data.removed) if (!unwritten.has(id)) { known.delete(id); takes.delete(id); }
  show(takes);
});
// Keeps both changes when two tabs changed a take: this tab's change becomes a separate take.
function keep_both(other) {
  const own = find_take(other.id), takes = by_ids();
  const copy = {...own, id: new_id(), made: own.made + 0.001, name: `${own.name}, other tab`};
  known.set(other.id, other.version);
  unwritten.delete(other.id);
  unwritten.set(copy.id, copy);
  show(takes.set(other.id, other).set(copy.id, copy), state.current === other.id ? copy.id : state.current);
  say(`“${own.name}” has changed in another tab, too; the page keeps both`);
}
