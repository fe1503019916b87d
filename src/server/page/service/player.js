// SPDX-License-Identifier: MIT
// Plays takes, tests tactors, stops; and says where the moment is.
import {state, changed, on_change, current_take, take_by_id, is_simulated, ceiling_dbfs, take_gain, say} from "../state.js";
import {call, tell, is_connected, server_now_s, from_server_ms, on_notification, on_lost, SLOW_MS} from "./connection.js";
import {make_request, take_s, take_from} from "../takes/takes.js";
import {weaken_take} from "./planner.js";
import {start_loudspeaker} from "./loudspeaker.js";

const TEST_S = 0.5;
const AHEAD_S = 0.4;      // before the end, when the next round of a loop is asked for
const STOP_AGAIN_MS = 500; // between stops that are not answered
const ended = new Set();  // numbers whose end came before the answer that named them
let speaker = null;

// Plays the take, from a moment on if it is said.
export async function play({from_s = 0} = {}) {
  const take = current_take();
  if (!take?.strokes.length) return;
  // It begins anew: copies of it never add up.
  end_round(state.playing);
  silence_speaker();
  const felt = is_connected() && !["lost", "muted", "closing"].includes(state.stream.state);
  state.stopped = null;
  state.playing = {take: take.id, began_ms: performance.now(), total_s: (state.plan?.total_s ?? take_s(take)) - from_s, numbers: new Set(),
    felt, from_s};
  state.at_s = from_s;
  if (felt) await ask_to_play();
  else await play_unfelt(take, state.playing);
  changed("playing");
}
async function play_unfelt(take, own) {
  if (!is_simulated() || !state.speaker) say(state.link === "connected" ? "No card: shown, not felt" : "No connection: shown, not felt");
  // What is new waits for its plan.
  for (own.waits = true; is_connected() && state.playing === own && is_shown(own) && state.plan_of?.id !== take.id;)
    await new Promise(done => setTimeout(done, 10));
  Object.assign(own, {began_ms: performance.now(), total_s: (state.plan?.total_s ?? take_s(take)) - own.from_s, waits: false});
  if (state.playing !== own) return;
  if (is_shown(own)) hear_it(); else end_playing();
}
on_change(what => { if (what.has("level")) speaker?.set_gain(take_gain()); });

// Tells the service the level: all that this page plays is played at the ceiling and turned down there, so that what sounds
// follows, too.
let told_db = null; // as the service knows it
export function tell_level() {
  if (!is_connected() || told_db === state.level_db) return;
  told_db = state.level_db;
  tell("level", {db: told_db});
}
on_change(tell_level);
on_lost(() => { told_db = null; });

async function ask_to_play() {
  const own = state.playing, take = take_by_id(own.take);
  try {
    tell_level();
    const r = await call("play", make_request(take_from(take, own.from_s), ceiling_dbfs()));
    if (state.playing !== own) return cancel_strokes(r.strokes);
    own.total_s = r.total_s;
    own.numbers = new Set(r.strokes.filter(n => !ended.has(n)));
    ended.clear();
    own.next = null;
    own.waits = true; // until it sounds
  } catch (e) {
    if (state.playing !== own) return;
    // Strokes of several fingers add up: the take is played as strong as it may be.
    if (e.code !== 0 && !own.weakened && await weaken_take(take).catch(() => false)) {
      own.weakened = true;
      return state.playing === own ? ask_to_play() : undefined;
    }
    if (state.playing !== own) return;
    state.playing = null;
    if (state.plan_fault) say("It cannot be played: the warning at its settings says why");
    else if (e.code !== 0) { state.fault = e.message; changed("link"); }
  }
  changed("playing");
}

// A take that was chosen meanwhile is not the one that sounds.
const is_shown = p => p.take === state.current;
// Moves the moment on; called once a frame.
export function tick() {
  const p = state.playing;
  if (!p) return;
  const t = (performance.now() - p.began_ms) / 1000;
  if (is_shown(p)) state.at_s = p.from_s + (p.waits ? 0 : Math.max(0, Math.min(p.total_s, t)));
  if (state.loop && p.felt && !p.waits && !p.next && t > p.total_s - AHEAD_S && p.numbers.size) next_round(p);
  if (t < p.total_s || p.waits) return;
  if (p.next) return;
  if (state.loop && !p.felt) {
    Object.assign(p, {began_ms: p.began_ms + p.total_s * 1000, total_s: p.total_s + p.from_s, from_s: 0});
    return hear_it();
  }
  if (p.felt && p.numbers.size && t < p.total_s + 1) return; // its end is told
  end_playing();
}
const cancel_strokes = numbers => numbers.forEach(n => tell("cancel", {stroke: n}));
function end_round(p) {
  if (!p?.felt) return;
  cancel_strokes([...p.numbers]);
  p.numbers.clear();
}
async function next_round(p) {
  const take = take_by_id(p.take);
  if (!take) return;
  p.next = true;
  const at = Math.max(server_now_s() + 0.05, server_now_s() + p.total_s - (performance.now() - p.began_ms) / 1000);
  try {
    const r = await call("play", {...make_request(take, ceiling_dbfs()), start: {monotonic_s: at}});
    if (state.playing !== p) return cancel_strokes(r.strokes);
    r.strokes.forEach(n => p.numbers.add(n));
    p.next = {number: r.stroke, total_s: r.total_s};
  } catch { p.next = null; state.loop = false; changed("playing"); }
}

on_notification("stroke", s => {
  const p = state.playing;
  if (s.state === "started") {
    if (p?.numbers.has(s.stroke) && s.started_s !== null) {
      const is_next = !p.waits && p.next?.number === s.stroke;
      if (is_next) Object.assign(p, {total_s: p.next.total_s, next: null, from_s: 0});
      if (p.waits || is_next) {
        Object.assign(p, {began_ms: from_server_ms(s.started_s), waits: false});
        hear_it();
      }
      changed("playing");
    }
    return;
  }
  if (p?.numbers.delete(s.stroke)) {
    if (s.state !== "finished") {
      if (s.state === "interrupted") { state.fault = `The stroke was interrupted: ${s.reason}`; changed("link"); }
      end_playing();
    } else if (!p.numbers.size && !(state.loop && p.next)) {
      if (is_shown(p)) state.at_s = p.from_s + p.total_s;
      end_playing();
    }
  } else if (state.playing) ended.add(s.stroke);
});
function end_playing() {
  state.playing = null;
  state.tapped = -1;
  silence_speaker();
  changed("playing");
}
on_lost(() => { if (state.playing?.felt) end_playing(); });
on_notification("stops", s => {
  const own = s.client === state.hello?.client;
  state.stopped = {name: own ? "you" : s.client === 0 ? "the owner" : s.name ? `“${s.name}”` : "somebody", at: performance.now()};
  say(own ? "Stopped, everybody's strokes" : `Stopped by ${state.stopped.name}`);
  changed("link", "playing");
});
// They come in a tab that is hidden, too, where there are no frames: a loop goes on.
on_notification("levels", l => { if (!is_simulated()) state.dbfs = l.dbfs; if (document.hidden) tick(); });
on_notification("stream", s => { state.stream = s; changed("stream", "link"); });
on_notification("touches", t => {
  if (t.down) state.touches.set(t.stroke, {...t, at: performance.now()}); else state.touches.delete(t.stroke);
});

// Sends a stop before anything else is done: nothing of this page's own may keep it back. It is sent again until it is answered.
export function stop() {
  const sent = call("stop"), own = state.stopping ??= {since_ms: performance.now()};
  own.sent_ms = performance.now();
  sent.then(() => {
    if (state.stopping !== own) return;
    state.stopping = null;
    changed("link");
  }, () => { if (!is_connected()) say("No connection: use the amplifier's switch"); });
  end_playing();
  lift_fingers?.();
  return sent;
}
const is_unanswered = s => performance.now() - s.since_ms > SLOW_MS;
// Returns for how long a stop has not been answered, s; 0 where there is none, or it is young.
export const unanswered_s = () => state.stopping && is_unanswered(state.stopping)
  ? (performance.now() - state.stopping.since_ms) / 1000 : 0;
setInterval(() => {
  if (!unanswered_s()) return;
  if (is_connected() && performance.now() - state.stopping.sent_ms > STOP_AGAIN_MS) stop();
  changed("link");
}, 100);
let lift_fingers = null;
export function on_stop(f) { lift_fingers = f; }

export function test_tactor(i) {
  if (!is_connected()) return say("No connection: nothing is driven");
  if (is_simulated()) return tap_tactor(i);
  tell_level();
  call("drive", {tactor: i, duration_s: TEST_S})
    .then(() => say(`Tactor ${i}, ${TEST_S} s`), e => say(e.message));
}

// Without a card a tactor that is tried is a sound.
function tap_tactor(i) {
  state.tapped = i;
  if (i >= 0) setTimeout(tap_tactor, 1000 * TEST_S, -1);
  changed("playing");
}
// Plays on this computer's loudspeakers where that is asked for.
function hear_it() {
  silence_speaker();
  if (!state.speaker || !state.plan || !state.hello) return;
  speaker = start_loudspeaker({...state.plan, places: state.hello.array.tactors}, state.at_s, {gain: take_gain(), pitched: is_simulated()});
}
export function silence_speaker() { speaker?.stop(); speaker = null; }
export function look_at(s) {
  if (state.playing) return;
  state.at_s = Math.max(0, Math.min(state.plan?.total_s ?? take_s(current_take()), s));
  changed("moment");
}
