// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {start_loudspeaker} from "../../src/server/page/service/loudspeaker.js";

// Stands in for an AudioParam: keeps what is scheduled, and gives the value at a time.
class Param {
  events = [];
  value = 0;
  setValueAtTime(value, at) { this.events.push({at, value}); }
  linearRampToValueAtTime(value, at) { this.events.push({at, value, ramp: true}); }
  setTargetAtTime(value, at) { this.events.push({at, value}); }
  at(t) {
    const after = this.events.findIndex(e => e.at > t), last = this.events.at(-1);
    if (after < 0) return last?.value ?? this.value;
    if (after === 0) return this.value;
    const [a, b] = [this.events[after - 1], this.events[after]];
    return b.ramp ? a.value + (b.value - a.value) * (t - a.at) / (b.at - a.at) : a.value;
  }
}
class Context {
  currentTime = 7;
  closed = false;
  master = null;
  gains = []; // of strokes, each with the panner of its tactor
  panners = [];
  oscillators = [];
  destination = {};
  createGain() {
    const own = {gain: new Param(), connect: to => { own.to = to; return to; }};
    if (this.master) this.gains.push(own); else this.master = own.gain;
    return own;
  }
  createStereoPanner() { const pan = new Param(); this.panners.push({pan, connect() {}}); return this.panners.at(-1); }
  createOscillator() { this.oscillators.push(new Param()); return {frequency: this.oscillators.at(-1), connect: to => to, start() {}}; }
  async resume() {}
  close() { this.closed = true; }
}

// Starts strokes of rows [onset, duration, amplitude of each tactor] on tactors 20 mm apart. The context's time goes by with the timers'.
function start(t, strokes, at_s = 0, options = {}) {
  const rows = strokes.flatMap(s => s.rows), count = rows[0].length - 2, context = new Context(), timers = [];
  let first = 0;
  const plan = {tactors: count, onsets: rows.map(r => r[0]), durations: rows.map(r => r[1]), amplitudes: rows.flatMap(r => r.slice(2)),
    strokes: strokes.map(s => ({first: (first += s.rows.length) - s.rows.length, count: s.rows.length, continuous: s.continuous ?? false}))};
  const add = repeats => (call, ms) => timers.push({call, repeats, s: ms / 1000, due_s: context.currentTime + ms / 1000});
  t.mock.method(globalThis, "setInterval", add(true));
  t.mock.method(globalThis, "setTimeout", add(false));
  t.mock.method(globalThis, "clearInterval", number => { timers[number - 1].due_s = Infinity; });
  const sound = start_loudspeaker(plan, Array.from({length: count}, (_, i) => ({x_mm: 20 * i, y_mm: 0})), at_s, {context, ...options});
  const pass = seconds => {
    for (let i = 0; i < 20 * seconds; ++i) {
      context.currentTime += 0.05;
      for (const timer of timers.filter(each => each.due_s <= context.currentTime)) {
        timer.due_s = timer.repeats ? context.currentTime + timer.s : Infinity;
        timer.call();
      }
    }
  };
  // Returns the sum of the gains of a tactor at a moment of the plan.
  const gain = (tactor, t_s) => context.gains.filter(g => g.to === context.panners[tactor]).reduce((sum, g) => sum + g.gain.at(7.05 + t_s - at_s), 0);
  return {context, sound, pass, gain, check: (tactor, values) => values.forEach(([t_s, v]) => close(gain(tactor, t_s), v, t_s))};
}
const close = (a, b, message) => assert.ok(Math.abs(a - b) < 1e-6, `${message ?? ""} ${a} is not ${b}`);

test("a burst has an envelope of 5 ms within its duration, a shorter one is a triangle", t => {
  const {check, context} = start(t, [{rows: [[0.1, 0.07, 0.8, 0]]}]);
  check(0, [[0, 0], [0.1, 0], [0.1025, 0.4], [0.105, 0.8], [0.165, 0.8], [0.1675, 0.4], [0.17, 0], [1, 0]]);
  assert.equal(context.gains.length, 1);
  start(t, [{rows: [[0, 0.004, 1]]}]).check(0, [[0.001, 0.5], [0.002, 1], [0.003, 0.5], [0.004, 0]]);
});

test("strokes at once add up", t => {
  start(t, [{rows: [[0, 0.1, 0.5]]}, {rows: [[0.05, 0.1, 0.25]]}]).check(0, [[0.04, 0.5], [0.07, 0.75], [0.12, 0.25]]);
});

test("a curve is linear between its rows, has no gaps and needs few points", t => {
  const {pass, check, gain} = start(t, [{continuous: true, rows: Array.from({length: 100}, (_, i) => [i * 0.02, 0.02, (i + 0.5) / 100])}]);
  pass(1);
  for (let at = 0.01; at < 1.99; at += 0.003) close(gain(0, at), at / 2, at);
  check(0, [[-0.001, 0], [2, 0], [2.1, 0]]);
  const many = start(t, [{continuous: true, rows: Array.from({length: 2000}, (_, i) => [i / 1000, 0.001, 0.5])}]);
  assert.ok(many.context.gains[0].gain.events.length < 500);
  many.check(0, [[1, 0.5]]);
});

test("tactors are places between left and right, and have a frequency by their place where that is asked for", t => {
  const rows = [[0, 0.1, 1, 1, 1]];
  assert.deepEqual(start(t, [{rows}]).context.panners.map(p => p.pan.value), [-1, 0, 1]);
  assert.deepEqual(start(t, [{rows: [[0, 0.1, 1]]}]).context.panners.map(p => p.pan.value), [0]);
  assert.deepEqual(start(t, [{rows}]).context.oscillators.map(o => o.value), [250]);
  assert.equal(start(t, [{rows}], 0, {pitched: true}).context.oscillators.length, 3);
});

test("the sum is well below full scale, and a gain lowers it only", t => {
  for (const [gain, largest] of [[undefined, 0.25], [0.1, 0.025], [4, 0.25]])
    close(start(t, [{rows: [[0, 0.1, 1, 1, 1]]}], 0, {gain}).context.master.value * 3, largest);
  const level = (...strokes) => 0.25 / start(t, strokes).context.master.value;
  close(level({rows: [[0, 0.1, 1, 0.5], [0.1, 0.1, 0.9, 0.2], [0.2, 0.1, 0.2, 0.2]]}), 1.5, "what follows does not add up");
  close(level({rows: [[0, 0.1, 1]]}, {rows: [[0.05, 0.1, 1]]}), 2, "what sounds at once does");
});

test("ten minutes are scheduled bit by bit on the same few nodes, from the middle, too", t => {
  const {context, pass, check} = start(t, [{rows: Array.from({length: 6000}, (_, i) => [i * 0.1, 0.05, i % 10 / 10])}], 100.32);
  check(0, [[100.32, 0], [100.33, 0.3], [100.42, 0.4]]); // a burst that has begun rises now
  assert.ok(context.gains[0].gain.events.length < 150);
  pass(300);
  for (const at of [400.12, 400.92, 401.32]) check(0, [[at, Math.round(10 * at - 0.2) % 10 / 10], [at - 0.05, 0]]);
  assert.equal(context.gains.length + context.oscillators.length, 2);
});

test("stop fades and ends it at once", t => {
  const {context, sound, pass} = start(t, [{rows: [[0, 5, 1], [5, 5, 1]]}]);
  pass(1);
  sound.set_gain(0.5);
  assert.equal(context.master.at(context.currentTime), 0.125);
  sound.stop();
  assert.equal(context.master.at(context.currentTime), 0);
  const scheduled = context.gains[0].gain.events.length;
  pass(6);
  assert.deepEqual([context.closed, context.gains[0].gain.events.length], [true, scheduled]);
});
