// SPDX-License-Identifier: MIT
// State of the page, and the listeners to its changes.
import {by_id, make} from "../../net/page/dom.js";
import {total_s} from "./takes/stroke.js";

const TOAST_MS = 2200, UNDO_MS = 6000;
export const LEAST_PART_S = 0.05; // shortest part of a take or a stroke that is played

export const state = {
  // The service.
  hello: null, link: "connecting", stream: {state: "", reason: ""}, status: null, slow: false, asks_token: "",
  lost_reason: "", retry_at: 0, // reason of a lost connection, and time of the next attempt
  fault: null,           // failure, for the banner
  stopped: null,         // {name, at}
  stopping: null,        // a stop without an answer: {since_ms, sent_ms}
  touches: new Map(),    // touches of other clients, by stroke: {x_mm, y_mm, client, at}
  dbfs: [],              // level of each tactor
  options: [],           // rows of the table of options that a client may set
  // Takes.
  takes: [], current: null, bin: [],
  trial: null,           // strokes to try, like a take; the first change makes them a take
  unkept: new Set(), storage_fault: "", // ids of takes that the browser has not stored, and the reason
  elsewhere: new Set(),  // ids of takes that another tab has just changed
  stroke: 0,             // index of the edited stroke
  knot: -1, tool: "draw", feel: true, append: false, level_db: 0, // level relative to the ceiling
  // Drawing, prediction and play.
  drawing: null,         // {began, before, tracks, kind, append}
  plan: null, plan_fault: null, plan_of: null, observer: null,
  outside: [],           // farthest place outside the array of each stroke
  playing: null,         // {take, began_ms, numbers, felt, waits, again, next, ending} and its round; see service/player.js
  at_s: 0, loop: false, speaker: false, scrub: true, hot: -1, tapped: -1,
  marks: {},             // on the time axis: {take, start_s, range: [from, until] or null}
  compare: null,         // comparison of two methods, see settings/compare.js
  tried: null,           // options of the card that is held, over those of the take
  tab: "method", sheet: "", placing: false, curve: "", // the curve that is touched: "speed", "strength"
};

export const now_ms = () => performance.now();

const listeners = [];
let pending = new Set();

// Calls f(changes) at most once a frame, with the set of changes, if it contains one of the names. Without names, calls it after each change except
// "ink", a further point of a drawing.
export function on_change(f, ...names) { listeners.push({f, names}); }
export function changed(...what) {
  const is_first = !pending.size;
  what.forEach(w => pending.add(w));
  if (!is_first) return;
  // A hidden tab has no frames.
  if (document.hidden) setTimeout(flush, 0); else requestAnimationFrame(flush);
}
function flush() {
  const now = pending, only_ink = now.size === 1 && now.has("ink");
  pending = new Set();
  for (const {f, names} of listeners) if (names.length ? names.some(n => now.has(n)) : !only_ink) f(now);
}

// Shows a message that goes away, with a button if something can be undone.
let toast_timer = 0;
export function say(text, take_back = null) {
  const toast = by_id("toast"), hide = () => toast.classList.remove("on");
  toast.replaceChildren(text, take_back ? make("button", {onclick: () => { take_back(); hide(); }}, "Undo") : "");
  toast.classList.add("on");
  clearTimeout(toast_timer);
  toast_timer = setTimeout(hide, take_back ? UNDO_MS : TOAST_MS);
}

// Small values that the browser remembers, if it can.
export const remembered = name => { try { return localStorage.getItem(`tactor-${name}`); } catch { return null; } };
export function remember(name, v) { try { localStorage.setItem(`tactor-${name}`, v); } catch { /* for this visit only */ } }

export const take_by_id = id => state.takes.find(t => t.id === id) ?? (state.trial?.id === id ? state.trial : null);
export const current_take = () => take_by_id(state.current);
// Returns the marks, clamped to the take, which may have become shorter since they were set.
export function marks() {
  if (state.marks.take !== state.current) return {start_s: 0};
  const {start_s, range} = state.marks, is_within = t => t < total_s(current_take()?.strokes ?? []) - LEAST_PART_S;
  return {...state.marks, start_s: is_within(start_s) ? start_s : 0, range: range && is_within(range[0]) ? range : null};
}
// Returns the stroke that is edited.
export const current_stroke = () => current_take()?.strokes[state.stroke] ?? null;
// Returns true if the service plays to the PCM null, its default.
const plays_to_nobody = () => state.hello?.stream.pcm === "null";
// Returns true if the service has never had a card, so it plays nothing.
export const is_cardless = () => state.link === "connected" && state.stream.state === "lost" && state.hello.stream.format === null;
// Returns true if nobody can feel the strokes, so the page makes them audible.
export const is_simulated = () => is_cardless() || state.link === "connected" && plays_to_nobody();
export const SILENT_DB = -60; // lowest level of the service
export const ceiling_dbfs = () => state.hello?.max_level_dbfs ?? -12;
export const level_dbfs = () => ceiling_dbfs() + state.level_db;
// Returns level and gain of the shown take, as a factor on amplitudes at the ceiling.
export const take_gain = () => 10 ** ((state.level_db + (current_take()?.gain_db ?? 0)) / 20);
