// SPDX-License-Identifier: MIT
// The moment that is dragged is felt: the burst under it, by a live stroke.
import {state, now_ms} from "../state.js";
import {tell} from "../service/connection.js";
import {look_at} from "../service/player.js";
import {begin_live, send} from "../drawing/pointer.js";

const STEP_MS = 50, REST_MS = 500; // between bursts; of a moment that rests, until it is silent
let live = null, moved_ms = 0, timer;

const has_stopped = since_ms => state.playing || state.stopping || state.stopped?.at > since_ms;
// Looks at a moment. It is felt unless a stop came after the drag began.
export function scrub_to(s, began_ms) {
  const before = state.at_s;
  look_at(s);
  if (!state.scrub || state.at_s === before || state.link !== "connected" || has_stopped(began_ms)) return;
  moved_ms = now_ms();
  timer ||= setInterval(feel_moment, STEP_MS);
}
export function end_scrub() {
  timer = clearInterval(timer);
  if (live) live.track.down = false; // one that has no number yet ends when it has
  if (live?.number) tell("end", {stroke: live.number});
  live = null;
}
function feel_moment() {
  const now = now_ms(), plan = state.plan, t = state.at_s + 1e-4;
  const row = plan?.onsets.findLastIndex((onset, i) => onset <= t && t < onset + plan.durations[i]) ?? -1;
  if (row < 0 || now - moved_ms > REST_MS || has_stopped(moved_ms)) return end_scrub();
  const is_new = !live;
  live ??= {number: null, sent_ms: 0, track: {down: true}};
  Object.assign(live, {at: plan.positions.slice(2 * row, 2 * row + 2), strength: plan.intensities[row]});
  if (is_new) begin_live(live); else send(live, now);
}
