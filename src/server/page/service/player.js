// SPDX-License-Identifier: MIT
// Plays takes, tests tactors, stops; and says where the moment is.
import {state, changed, current_take, level_gain, say} from "../state.js";
import {call, is_connected, server_now_s, from_server_ms, on_notification, on_lost} from "./connection.js";
import {make_request, take_s} from "../takes/takes.js";
import {too_strong_db, lower_level} from "./planner.js";
import {number_text} from "../words.js";
import {start_loudspeaker} from "./loudspeaker.js";

const TEST_S = 0.5;
const AHEAD_S = 0.4;      // before the end, when the next round of a loop is asked for
const ended = new Set();  // numbers whose end came before the answer that named them
let speaker = null;

export async function play() {
  const take = current_take();
  if (!take?.strokes.length) return;
  silence_speaker();
  const felt = is_connected() && !["lost", "muted", "closing"].includes(state.stream.state);
  state.stopped = null;
  // After a look at one moment it plays from the start.
  state.playing = {take: take.id, began_ms: performance.now(), total_s: state.plan?.total_s ?? take_s(take), numbers: new Set(),
    felt};
  state.at_s = 0;
  if (felt) await ask_to_play(); else say(state.link === "connected"
    ? "No card: shown, not felt" : "No connection: shown, not felt");
  if (!felt) hear_it();
  changed("playing");
}

async function ask_to_play() {
  const own = state.playing, take = state.takes.find(t => t.id === own.take);
  try {
    const r = await call("play", make_request(take));
    if (state.playing !== own) return;
    own.total_s = r.total_s;
    own.numbers = new Set(r.strokes.filter(n => !ended.has(n)));
    ended.clear();
    own.next = null;
    own.waits = true; // until it sounds
  } catch (e) {
    if (state.playing !== own) return;
    // Strokes of several fingers add up: they are played as strong as they may be.
    if (too_strong_db(e) > 0 && !own.lowered) {
      own.lowered = true;
      const before = state.level_db;
      await lower_level(e);
      if (state.playing !== own) return;
      say(`Level ${number_text(state.level_db - before)} dB: together the strokes are too strong`);
      return ask_to_play();
    }
    state.playing = null;
    if (state.plan_fault) say("It cannot be played: the warning at its settings says why");
    else if (e.code !== 0) { state.fault = e.message; changed("link"); }
  }
  changed("playing");
}

// Moves the moment on; called once a frame.
export function tick() {
  const p = state.playing;
  if (!p) return;
  const t = (performance.now() - p.began_ms) / 1000;
  state.at_s = Math.max(0, Math.min(p.total_s, t));
  if (p.waits) state.at_s = 0;
  if (state.loop && p.felt && !p.waits && !p.next && t > p.total_s - AHEAD_S && p.numbers.size) next_round(p);
  if (t < p.total_s || p.waits) return;
  if (p.next) return;
  if (state.loop && !p.felt) { p.began_ms += p.total_s * 1000; hear_it(); return; }
  if (p.felt && p.numbers.size && t < p.total_s + 1) return; // its end is told
  end_playing();
}
async function next_round(p) {
  p.next = true;
  const take = state.takes.find(t => t.id === p.take);
  if (!take) return;
  const at = Math.max(server_now_s() + 0.05, server_now_s() + p.total_s - (performance.now() - p.began_ms) / 1000);
  try {
    const r = await call("play", {...make_request(take), start: {monotonic_s: at}});
    if (state.playing !== p) return r.strokes.forEach(n => call("cancel", {stroke: n}).catch(() => {}));
    r.strokes.forEach(n => p.numbers.add(n));
    p.next = {number: r.stroke, total_s: r.total_s};
  } catch { p.next = null; state.loop = false; changed("playing"); }
}

on_notification("stroke", s => {
  const p = state.playing;
  if (s.state === "started") {
    if (p?.numbers.has(s.stroke) && s.started_s !== null) {
      const is_next = !p.waits && p.next?.number === s.stroke;
      if (is_next) Object.assign(p, {total_s: p.next.total_s, next: null});
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
      state.at_s = p.total_s;
      end_playing();
    }
  } else if (state.playing) ended.add(s.stroke);
});
function end_playing() {
  state.playing = null;
  silence_speaker();
  changed("playing");
}
on_lost(() => { if (state.playing?.felt) end_playing(); });
on_notification("stops", s => {
  const own = s.client === state.hello?.client;
  state.stopped = {name: own ? "you" : s.client === 0 ? "the owner" : s.name || "somebody", at: performance.now()};
  say(own ? "Stopped, everybody's strokes" : `Stopped by ${state.stopped.name}`);
  changed("link", "playing");
});
on_notification("levels", l => { state.dbfs = l.dbfs; });
on_notification("stream", s => { state.stream = s; changed("stream", "link"); });
on_notification("touches", t => {
  if (t.down) state.touches.set(t.stroke, {...t, at: performance.now()}); else state.touches.delete(t.stroke);
});

// Sends a stop before anything else is done: nothing of this page's own may keep it back.
export function stop() {
  const sent = call("stop");
  end_playing();
  lift_fingers?.();
  sent.catch(() => say(is_connected() ? "Stop was sent; tactor has not answered" : "No connection: use the amplifier's switch"));
  return sent;
}
let lift_fingers = null;
export function on_stop(f) { lift_fingers = f; }

export function test_tactor(i) {
  if (!is_connected()) return say("No connection: nothing is driven");
  call("drive", {tactor: i, intensity: level_gain(), duration_s: TEST_S})
    .then(() => say(`Tactor ${i}, ${TEST_S} s`), e => say(e.message));
}

// Plays on this computer's loudspeakers where that is asked for.
function hear_it() {
  silence_speaker();
  if (!state.speaker || !state.plan || !state.hello) return;
  speaker = start_loudspeaker({...state.plan, places: state.hello.array.tactors}, state.at_s, {gain: level_gain()});
}
export function silence_speaker() { speaker?.stop(); speaker = null; }
export function look_at(s) {
  if (state.playing) return;
  state.at_s = Math.max(0, Math.min(state.plan?.total_s ?? take_s(current_take()), s));
  changed("moment");
}
