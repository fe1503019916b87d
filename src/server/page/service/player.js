// SPDX-License-Identifier: MIT
// Plays takes, tests tactors, stops, and advances the time shown.
import {state, changed, on_change, current_take, take_by_id, is_cardless, is_simulated, ceiling_dbfs, take_gain, marks, say, now_ms, SILENT_DB} from "../state.js";
import {call, tell, is_connected, server_now_s, from_server_ms, on_notification, on_lost, SLOW_MS} from "./connection.js";
import {make_request, take_s, take_part, with_side} from "../takes/takes.js";
import {weaken_take} from "./planner.js";
import {clamp} from "../geometry.js";
import {start_loudspeaker} from "./loudspeaker.js";
import {fault_text, fault_sentence} from "../words.js";

const TEST_S = 0.5;
const AHEAD_S = 0.4;      // time before the end of a round at which changes are requested
const TOGETHER_S = 0.3, ROUNDING_S = 0.001; // time until both sides of a comparison begin, and its rounding
const STOP_AGAIN_MS = 500; // interval of stops without an answer
const ended = new Set(), begun = new Map(); // ends and starts of strokes that came before the answer with their numbers
let speaker = null;

// Returns the part that Play plays: the range, or everything from the start on.
const part_to_play = () => { const [from_s, until_s = Infinity] = marks().range ?? [marks().start_s]; return {from_s, until_s}; };
// Returns a round of a take: a part of it, its length, and the silence at its beginning (Infinity: always).
const make_round = (take, {from_s, until_s = Infinity}) => ({from_s, until_s, total_s: Math.min(until_s, take_s(take)) - from_s,
  lead_s: Math.min(...take_part(take, from_s, until_s).strokes.map(s => s.start_s))});
// Returns the values that decide how a round of a take sounds.
const ingredients = (take, {from_s, until_s}) => [take, from_s, until_s, state.compare?.other];
// Requests a round. If the page loops, the service repeats it without the page. Calls `start()` once everything is known.
async function ask_for(p, round, start) {
  const whole = take_by_id(p.take), take = take_part(whole, round.from_s, round.until_s), made_of = ingredients(whole, round);
  const repeats = state.loop && !state.tried && round.from_s === p.again.from_s && round.until_s === p.again.until_s;
  const round_s = repeats && state.compare ? await longest_s(take, round.total_s) : round.total_s;
  const answers = await submit(take, {start: start(), ...repeats && {repeat: true, round_s}, ...state.tried && {held: true}});
  const sound_s = Math.max(...answers.map(r => r.total_s)), strokes = answers.flatMap(r => r.strokes);
  Object.assign(round, {made_of, repeats, strokes, firsts: answers.map(r => r.stroke), sound_s, total_s: Math.max(sound_s, round_s), ending: false});
  return strokes;
}
// Returns the length of a round for both sides of a comparison: a plan may last longer than its stroke.
async function longest_s(take, total_s) {
  const plans = await Promise.all([0, 1].map(side => call("plan", {...make_request(with_side(take, side), ceiling_dbfs()), view: "peaks", bins: 1})));
  return Math.max(total_s, ...plans.map(plan => plan.total_s + ROUNDING_S));
}

// Plays the take, or a part of it.
export async function play(part = part_to_play()) {
  const take = current_take();
  if (!take?.strokes.length) return;
  const round = make_round(take, part);
  if (round.lead_s === Infinity) return say("Nothing plays in this range");
  // Ends the current round, so that copies never add up.
  end_round(state.playing);
  silence_speaker();
  const felt = is_connected() && !["lost", "muted", "closing"].includes(state.stream.state);
  state.stopped = null;
  state.playing = {take: take.id, began_ms: now_ms(), numbers: new Set(), felt, waits: felt, again: part_to_play(), ...round};
  state.at_s = round.from_s;
  if (felt) await ask_to_play();
  else await play_unfelt(take, state.playing);
  changed("playing");
}
// Plays the take with other options, again and again, until the function that it returns is called.
export function play_by(options) {
  if (state.compare || state.tried || !current_take()?.strokes.length) return null;
  const {loop} = state, change = (tried, is_loop) => { Object.assign(state, {tried, loop: is_loop, plan_of: null}); changed("take"); };
  change(options, true);
  play();
  return () => { quit_playing(); change(null, loop); };
}
async function play_unfelt(take, own) {
  if (!is_simulated() || !state.speaker) say(state.link === "connected" ? "No card: shown, not felt" : "No connection: shown, not felt");
  // A new take waits for its plan.
  own.waits = true;
  while (is_connected() && state.playing === own && is_shown(own) && state.plan_of?.id !== take.id)
    await new Promise(done => setTimeout(done, 10));
  Object.assign(own, {began_ms: now_ms(), total_s: Math.min(own.until_s, state.plan?.total_s ?? take_s(take)) - own.from_s, waits: false});
  if (state.playing !== own) return;
  if (is_shown(own)) hear_it(); else end_playing();
}
on_change(() => speaker?.set_gain(take_gain()), "level");

// Sends the level to the service, which plays this page's strokes at the ceiling and turns them down. So sounding strokes follow, too. Strokes of
// both sides of a comparison begin silent; those of one are raised after all were lowered. All ramps take 20 ms, so that the sum is never above the
// level. `anew`: there are new strokes.
let sent_level = null; // level that the service has
const side_of = new Map(); // side by the number of a stroke
export function tell_level(anew = false) {
  const on = state.compare?.on, now = `${on} ${state.level_db}`;
  if (!is_connected() || !anew && sent_level === now) return;
  if (!state.compare || !sent_level?.startsWith(`${on} `)) tell("level", {db: !state.compare ? state.level_db : SILENT_DB});
  sent_level = now;
  if (state.compare) for (const n of state.playing?.numbers ?? []) if (side_of.get(n) === on) tell("level", {db: state.level_db, stroke: n});
}
on_change(() => tell_level());
on_lost(() => { sent_level = null; });

async function ask_to_play() {
  const own = state.playing, take = take_by_id(own.take);
  try {
    tell_level();
    // Without a start, the service skips the silence before the first stroke.
    const strokes = await ask_for(own, own, () => state.compare ? {monotonic_s: server_now_s() + TOGETHER_S} : own.lead_s ? {delay_s: 0} : "now");
    if (state.playing !== own) return cancel_strokes(strokes);
    own.began_ms = now_ms();
    own.numbers = new Set(strokes.filter(n => !ended.has(n)));
    ended.clear();
    tell_level(state.compare);
    hear_starts(strokes);
    if (is_simulated() && !state.speaker) say("No card: shown, not felt");
  } catch (e) {
    if (state.playing !== own) return;
    // A tactor may have a lower limit than the level: the take is played as strong as it may be.
    if (e.code !== 0 && !own.weakened && await weaken_take(take).catch(() => false)) {
      own.weakened = true;
      return state.playing === own ? ask_to_play() : undefined;
    }
    if (state.playing !== own) return;
    state.playing = null;
    say_refusal(e);
  }
  changed("playing");
}
function say_refusal(e) {
  if (state.plan_fault) say("It cannot play; Settings says why");
  else if (e.code !== 0) { state.fault = fault_sentence(e); changed("link"); }
}

// Requests the strokes of a take, or of both sides of a comparison, which begin together. Returns the answers.
async function submit(take, how) {
  const sides = state.compare ? [0, 1] : [0];
  const all = await Promise.allSettled(sides.map(side => call("play", {...make_request(with_side(take, side), ceiling_dbfs()), ...how})));
  const answers = all.flatMap((a, side) => a.value ? [{...a.value, side}] : []), refused = all.find(a => a.reason);
  for (const r of answers) r.strokes.forEach(n => side_of.set(n, r.side));
  if (!refused) return answers;
  answers.forEach(r => cancel_strokes(r.strokes));
  throw refused.reason;
}
function hear_starts(strokes) {
  strokes.forEach(n => begun.has(n) && hear_stroke(begun.get(n)));
  begun.clear();
}

// Returns true if the sounding take is the one that is shown.
const is_shown = p => p.take === state.current;
// Advances the time shown; called once a frame.
export function tick() {
  const p = state.playing;
  if (!p) return;
  const is_new = begin_round(p), t = (now_ms() - p.began_ms) / 1000;
  if (is_shown(p)) state.at_s = p.from_s + clamp(t, 0, p.waits ? p.lead_s : p.total_s);
  if (is_new) hear_it();
  if (p.felt && !p.waits && !p.next) follow_changes(p, t);
  if (t < p.total_s || p.waits || p.next || p.repeats) return;
  if (p.felt && p.numbers.size && t < p.total_s + 1) return; // the service reports its end
  end_playing();
}
// Begins the next round if it is time. Returns true if it did.
function begin_round(p) {
  const now = now_ms(), rounds = Math.floor((now - p.began_ms) / (1000 * p.total_s));
  if (p.next?.began_ms <= now) {
    Object.assign(p, p.next, {next: null});
    return true;
  }
  const round = !p.waits && rounds >= 1 && (p.repeats ? p : !p.felt && state.loop && round_after(p));
  if (round) Object.assign(p, round, {began_ms: p.began_ms + 1000 * p.total_s * (p.repeats ? rounds : 1)});
  return Boolean(round);
}
// Ends a loop at the end of its round if it was switched off or its take was deleted. Requests changes shortly before that.
function follow_changes(p, t) {
  const take = take_by_id(p.take), loops = state.loop && take;
  if (p.repeats && !p.ending && !loops) {
    p.ending = true;
    p.firsts.forEach(n => tell("end", {stroke: n}));
  }
  if (!loops) return;
  const has_changed = () => ingredients(take, is_shown(p) ? part_to_play() : p.again).some((v, i) => v !== p.made_of[i]);
  if (!p.repeats || p.ending || t > p.total_s - AHEAD_S && has_changed()) next_round(p);
}
const cancel_strokes = numbers => numbers.forEach(n => tell("cancel", {stroke: n}));
function end_round(p) {
  if (!p?.felt) return;
  cancel_strokes([...p.numbers]);
  p.numbers.clear();
}
// Returns the round that plays next; the marks may have changed meanwhile.
function round_after(p) {
  const take = take_by_id(p.take);
  if (is_shown(p)) p.again = part_to_play();
  return take && make_round(take, p.again);
}
async function next_round(p) {
  const round = round_after(p), ends_s = server_now_s() + p.total_s - (now_ms() - p.began_ms) / 1000;
  p.next = true;
  try {
    const strokes = await ask_for(p, round, () => p.repeats ? {after: p.firsts} : {monotonic_s: Math.max(server_now_s() + 0.05, ends_s)});
    if (state.playing !== p) return cancel_strokes(strokes);
    strokes.forEach(n => p.numbers.add(n));
    tell_level(state.compare);
    p.next = round;
    hear_starts(strokes);
  } catch (e) {
    if (state.playing !== p) return;
    p.next = null;
    state.loop = false;
    say_refusal(e);
    changed("playing");
  }
}

on_notification("stroke", hear_stroke);
function hear_stroke(s) {
  const p = state.playing;
  if (s.state === "started") {
    if (p && !p.numbers.has(s.stroke)) begun.set(s.stroke, s);
    if (p?.numbers.has(s.stroke) && s.started_s !== null) {
      // The service reports a start before it is heard: the previous round continues until its end.
      const round = p.waits ? p : p.next?.strokes?.includes(s.stroke) && !p.next.began_ms && p.next;
      if (round) round.began_ms = from_server_ms(s.started_s) - round.lead_s * 1000;
      if (p.waits) { p.waits = false; tick(); hear_it(); }
      changed("playing");
    }
    return;
  }
  side_of.delete(s.stroke);
  if (p?.numbers.delete(s.stroke)) {
    if (s.state !== "finished") {
      if (s.state === "interrupted") { state.fault = `The stroke was interrupted: ${s.reason}`; changed("link"); }
      end_playing();
    } else if (!p.numbers.size && !p.next) {
      p.repeats = false; // the silence at the end of the round is still to come
      if (p.total_s !== p.sound_s) return;
      if (is_shown(p)) state.at_s = p.from_s + p.total_s;
      end_playing();
    }
  } else if (state.playing) ended.add(s.stroke);
}
// Ends everything that this page plays.
export function quit_playing() {
  end_round(state.playing);
  end_playing();
}
function end_playing() {
  state.playing = null;
  state.tapped = -1;
  silence_speaker();
  changed("playing");
}
on_lost(() => { if (state.playing?.felt) end_playing(); });
on_notification("stops", s => {
  const own = s.client === state.hello?.client;
  state.stopped = {name: own ? "you" : s.client === 0 ? "the owner" : s.name ? `“${s.name}”` : "somebody", at: now_ms()};
  say(own ? "Stopped everybody's strokes" : `Stopped by ${state.stopped.name}`);
  changed("link", "playing");
});
// Handles levels in a hidden tab, too, which has no frames: a loop continues.
on_notification("levels", l => { if (!is_cardless()) state.dbfs = l.dbfs; if (document.hidden) tick(); });
on_notification("stream", s => { state.stream = s; changed("stream", "link"); });
on_notification("touches", t => {
  if (t.down) state.touches.set(t.stroke, {...t, at: now_ms()}); else state.touches.delete(t.stroke);
});

// Sends a stop before all else: nothing in this page may hold it up. Sends it again until the service answers.
export function stop() {
  const sent = call("stop"), own = state.stopping ??= {since_ms: now_ms()};
  Object.assign(own, {sent_ms: now_ms(), fault: null});
  sent.then(() => {
    if (state.stopping !== own) return;
    state.stopping = null;
    changed("link");
  }, e => {
    own.fault = e;
    if (!is_connected()) say("No connection: switch the amplifier off");
  });
  end_playing();
  lift_fingers?.();
  return sent;
}
const is_unanswered = s => now_ms() - s.since_ms > SLOW_MS;
// Returns the time for which a stop has had no answer, s; 0 without one, or soon after it.
export const unanswered_s = () => state.stopping && is_unanswered(state.stopping)
  ? (now_ms() - state.stopping.since_ms) / 1000 : 0;
// Returns the state of that stop in words, for the button and the banner.
export function stop_words() {
  const e = state.stopping.fault;
  return !e ? ["no answer", "sent, but tactor does not answer"] : e.code ? ["refused", `refused: ${fault_text(e)}`]
    : e.sent ? ["no answer", "sent, but the connection is gone"] : ["not sent", "not sent: there is no connection to tactor"];
}
setInterval(() => {
  if (!unanswered_s()) return;
  if (is_connected() && now_ms() - state.stopping.sent_ms > STOP_AGAIN_MS) stop();
  changed("link");
}, 100);
let lift_fingers = null;
export function on_stop(f) { lift_fingers = f; }

export function test_tactor(i) {
  if (!is_connected()) return say("No connection: nothing plays");
  if (is_simulated()) tap_tactor(i);
  if (is_cardless()) return;
  tell_level();
  call("drive", {tactor: i, duration_s: TEST_S})
    .then(r => {
      if (state.compare) tell("level", {db: state.level_db, stroke: r.stroke});
      say(`Tactor ${i}, ${TEST_S} s`);
    }, e => say(fault_sentence(e)));
}

// Plays a tactor that is tried as a sound if there is no card, until a time or tap_tactor(-1).
let tap_timer = 0;
export function tap_tactor(i, ms = 1000 * TEST_S) {
  state.tapped = i;
  clearTimeout(tap_timer);
  if (i >= 0 && ms < Infinity) tap_timer = setTimeout(tap_tactor, ms, -1);
  changed("playing");
}
// Plays on this computer's loudspeakers if Listen is on.
export function hear_it() {
  silence_speaker();
  if (!state.speaker || !state.plan || !state.hello || state.playing && state.plan_of?.id !== state.playing.take) return;
  speaker = start_loudspeaker(state.plan, state.hello.array.tactors, state.at_s, {gain: take_gain(), pitched: is_simulated()});
}
on_change(() => { if (!speaker && state.playing && !state.playing.waits) hear_it(); }, "plan"); // begins when the plan of a new take has come
export function silence_speaker() { speaker?.stop(); speaker = null; }
export function look_at(s) {
  if (state.playing) return;
  state.at_s = clamp(s, 0, state.plan?.total_s ?? take_s(current_take()));
  changed("moment");
}
