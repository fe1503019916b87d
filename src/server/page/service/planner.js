// SPDX-License-Identifier: MIT
// Plans for the picture: one request at a time, always for the newest state.
import {state, ceiling_dbfs, changed, on_change, current_take, say, now_ms, take_by_id} from "../state.js";
import {call, is_connected} from "./connection.js";
import {make_request, put_take, with_side} from "../takes/takes.js";
import {number_text} from "../words.js";
import {thin} from "../takes/stroke.js";

const DRAFTED_POINTS = 2000; // most points of a drawing; more are thinned out before they are sent

let draft = 0, busy = false, owed = false;

function request() {
  const take = current_take(), strokes = state.drawing ? draw_so_far(state.drawing) : take?.strokes;
  return strokes?.length ? make_request(with_side({...take, strokes})) : null;
}
// Returns the strokes of an unfinished drawing.
function draw_so_far({before, tracks}) {
  return [...before, ...tracks.filter(k => k.points.length > 1).map(k => ({name: "drawing", start_s: k.start_s,
    timed: k.points.length > DRAFTED_POINTS ? thin(k.points, 0.1) : k.points}))];
}

// Returns the plan of a request with the prediction: rows of felt places for each stroke.
async function predict(what, more = {}) {
  const plan = await call("plan", {...what, view: "percept", ...more, ...state.observer && {observer: state.observer}});
  plan.felt_rows = plan.strokes.map(s => plan.felt.slice(s.felt_first, s.felt_first + s.felt_count));
  return plan;
}
function plan_soon() {
  if (busy) { owed = true; return; }
  if (is_connected()) ask();
}
async function ask() {
  const what = request();
  owed = false;
  if (!what) {
    Object.assign(state, {plan: null, plan_fault: null});
    return changed("plan");
  }
  busy = true;
  const began = now_ms();
  const take = current_take(), was_drawing = state.drawing !== null, {tried} = state;
  try {
    const c = state.compare, on = c?.on, plan = await predict(what, {draft: ++draft});
    const rest = c && await predict(make_request(with_side(take, 1 - on))).catch(() => null);
    if (was_drawing || current_take() === take && state.tried === tried && state.compare?.on === on) Object.assign(state, {plan, plan_fault: null,
      plan_of: was_drawing ? null : take});
    if (c) c.rest = rest;
  } catch (e) {
    if (e.code !== 0 && e.data?.why !== "outdated") Object.assign(state, {plan: null, plan_fault: e, plan_of: take});
  }
  changed("plan");
  // A long drawing is planned less often: its picture must not slow down the hand.
  if (was_drawing) await new Promise(done => setTimeout(done, Math.min(2000, 2 * (now_ms() - began) - 20)));
  busy = false;
  if (owed) ask();
}
// Returns the excess level of a plan's strokes, dB.
export const excess_db = plan => plan?.warnings.find(w => w.kind === "level")?.over_db ?? 0;
// Returns, in words, the tactor that exceeds its own limit most; empty if none does. `dbfs`: level of full amplitude.
export function limit_text({tactors: count, amplitudes}, dbfs) {
  const {array, max_level_dbfs} = state.hello, over = array.tactors.map((t, i) => {
    let most = 0;
    for (let k = i; k < amplitudes.length; k += count) most = Math.max(most, amplitudes[k]);
    return t.max_dbfs < max_level_dbfs ? dbfs + 20 * Math.log10(most) - t.max_dbfs : -Infinity;
  });
  const worst = over.indexOf(Math.max(...over)), {max_dbfs} = array.tactors[worst];
  return over[worst] > 0 ? `tactor ${worst} is limited to ${number_text(max_dbfs, max_dbfs % 1 ? 1 : 0)} dBFS` : "";
}
// Sets a take's gain so that it can be played; the level of other takes stays. Returns false if it is not too strong, and for strokes that are only
// tried.
export async function weaken_take(take) {
  const plan = await call("plan", {...make_request(with_side(take), ceiling_dbfs()), view: "peaks", bins: 1}), over_db = excess_db(plan);
  const now = take_by_id(take.id); // the take may have been edited meanwhile
  if (!over_db || !now) return false;
  const gain_db = (now.gain_db ?? 0) - Math.ceil(2 * over_db) / 2;
  if (now === state.trial) { state.trial = {...now, gain_db}; changed("take"); } else put_take({...now, gain_db});
  const limit = limit_text({...plan, amplitudes: plan.peaks}, ceiling_dbfs() + (now.gain_db ?? 0));
  say(`“${now.name}” ${number_text(gain_db)} dB: ${limit || "it would be too strong"}`);
  return true;
}

// Drops the plan of another take, or of this one before a change: without a connection no new plan replaces it.
function forget_other_plan() {
  if (is_connected() || !state.plan && !state.plan_fault || !state.drawing && state.plan_of === current_take()) return;
  Object.assign(state, {plan: null, plan_fault: null, plan_of: null});
  changed("plan");
}
on_change(() => { forget_other_plan(); plan_soon(); }, "take", "drawing", "ink", "level", "link", "observer");
