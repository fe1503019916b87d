// SPDX-License-Identifier: MIT
// The moment that is dragged is felt: the burst under it, by a live stroke.
import {state, current_take} from "../state.js";
import {tell} from "../service/connection.js";
import {look_at} from "../service/player.js";
import {begin_live, send} from "../drawing/pointer.js";

const STEP_MS = 50;  // between bursts
const REST_MS = 500; // of a moment that rests, until it is silent
let held_touch = null, moved_ms = 0, timer;

const has_stopped = since_ms => state.playing || state.stopping || state.stopped?.at > since_ms;
// Looks at a moment. It is felt unless a stop came after the drag began.
export function scrub_to(s, began_ms) {
  const before = state.at_s;
  look_at(s);
  if (!state.scrub || state.at_s === before || state.link !== "connected" || has_stopped(began_ms)) return;
  moved_ms = performance.now();
  timer ||= setInterval(feel_moment, STEP_MS);
}
export function end_scrub() {
  timer = clearInterval(timer);
  lift_touch();
}
function lift_touch() {
  if (held_touch) held_touch.track.down = false; // one that has no number yet ends when it has
  if (held_touch?.number) tell("end", {stroke: held_touch.number});
  held_touch = null;
}
function feel_moment() {
  const now = performance.now(), plan = state.plan, t = state.at_s + 1e-4;
  if (now - moved_ms > REST_MS || has_stopped(moved_ms)) return end_scrub();
  const row = plan?.onsets.findLastIndex((onset, i) => onset <= t && t < onset + plan.durations[i]) ?? -1;
  if (row < 0) return lift_touch();
  const feel = held_touch ? send : begin_live;
  held_touch ??= {number: null, sent_ms: 0, track: {down: true}};
  Object.assign(held_touch, {at: plan.positions.slice(2 * row, 2 * row + 2),
    strength: plan.intensities[row] * 10 ** ((current_take().gain_db ?? 0) / 20)});
  feel(held_touch, now);
}
