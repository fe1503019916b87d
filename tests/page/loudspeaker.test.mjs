// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {largest_sum, plan_ramps, ramps_by_slice, slice_gains, start_loudspeaker} from "../../src/server/page/service/loudspeaker.js";

// Makes a plan for tactors 20 mm apart from strokes of rows [onset, duration, amplitude of each tactor].
function make_plan(count, ...strokes) {
  const places = Array.from({length: count}, (_, i) => ({x_mm: 20 * i, y_mm: 0}));
  const plan = {tactors: count, places, strokes: [], onsets: [], durations: [], amplitudes: []};
  for (const {continuous = false, rows} of strokes) {
    plan.strokes.push({first: plan.onsets.length, count: rows.length, continuous});
    for (const [onset, duration, ...amplitudes] of rows) {
      plan.onsets.push(onset);
      plan.durations.push(duration);
      plan.amplitudes.push(...amplitudes);
    }
  }
  plan.total_s = Math.max(...plan.onsets.map((t, i) => t + plan.durations[i]));
  return plan;
}

// Returns the gain of a tactor at a time, as the browser makes it from the points.
function gain_at(points, t_s) {
  const i = points.findIndex(([t]) => t >= t_s);
  if (i <= 0) return points[0]?.[1] ?? 0;
  const [[t0, g0], [t1, g1]] = points.slice(i - 1, i + 1);
  return g0 + (g1 - g0) * (t_s - t0) / (t1 - t0);
}
const close = (a, b, message) => assert.ok(Math.abs(a - b) < 1e-6, `${message ?? ""} ${a} is not ${b}`);
const gains = (plan, from_s, to_s) => slice_gains(plan, plan_ramps(plan), from_s, to_s);

test("a burst has an envelope of 5 ms within its duration", () => {
  const [first, second] = gains(make_plan(2, {rows: [[0.1, 0.07, 0.8, 0]]}), 0, 1);
  assert.deepEqual(second, []);
  for (const [t, gain] of [[0, 0], [0.1, 0], [0.1025, 0.4], [0.105, 0.8], [0.165, 0.8], [0.1675, 0.4], [0.17, 0], [1, 0]]) close(gain_at(first, t), gain, t);
});

test("a burst shorter than two envelopes is a triangle", () => {
  const [points] = gains(make_plan(1, {rows: [[0, 0.004, 1]]}), 0, 1);
  for (const [t, gain] of [[0.001, 0.5], [0.002, 1], [0.003, 0.5], [0.004, 0]]) close(gain_at(points, t), gain, t);
});

test("bursts at once add up", () => {
  const plan = make_plan(1, {rows: [[0, 0.1, 0.5]]}, {rows: [[0.05, 0.1, 0.25]]});
  const [points] = gains(plan, 0, 1);
  for (const [t, gain] of [[0.04, 0.5], [0.07, 0.75], [0.12, 0.25]]) close(gain_at(points, t), gain, t);
});

test("a curve is linear between its rows and has no gaps", () => {
  const rows = Array.from({length: 100}, (_, i) => [i * 0.02, 0.02, (i + 0.5) / 100]);
  const plan = make_plan(1, {continuous: true, rows});
  for (const [from, to] of [[0, 1], [1, 2]]) {
    const [points] = gains(plan, from, to);
    for (let t = Math.max(from, 0.02); t <= Math.min(to, 1.98); t += 0.003) close(gain_at(points, t), t / 2, t);
  }
  close(gain_at(gains(plan, 1, 3)[0], 2), 0);
});

test("a curve with many rows needs few points", () => {
  const rows = Array.from({length: 2000}, (_, i) => [i / 1000, 0.001, 0.5]);
  const [points] = gains(make_plan(1, {continuous: true, rows}), 0, 1);
  assert.ok(points.length < 1000, points.length);
  assert.ok(points.every(([t, g]) => t < 0.01 || Math.abs(g - 0.5) < 1e-6));
});

test("slices join, and each has the rows that it needs", () => {
  const rows = Array.from({length: 600}, (_, i) => [i * 0.0137, 0.05, (i * 7 % 11) / 11, (i * 5 % 13) / 13]);
  const plan = make_plan(2, {rows}, {rows: [[0.5, 3, 0.3, 0.1]]});
  const ramps = plan_ramps(plan), slices = ramps_by_slice(ramps), whole = slice_gains(plan, ramps, 0, 10);
  slices.forEach((some, i) => {
    assert.ok(some.length < 100);
    slice_gains(plan, some, i, i + 1).forEach((points, tactor) => {
      for (let t = i; t <= i + 1; t += 0.0101) close(gain_at(points, t), gain_at(whole[tactor], t), `${tactor} ${t}`);
      assert.deepEqual([points[0][0], points.at(-1)[0]], [i, i + 1]);
    });
  });
});

test("the sum counts what sounds at once, and a curve once", () => {
  const sum = plan => largest_sum(plan, plan_ramps(plan));
  close(sum(make_plan(2, {rows: [[0, 0.1, 1, 0.5], [0.1, 0.1, 0.2, 0.2]]})), 1.5);
  close(sum(make_plan(1, {rows: [[0, 0.1, 1]]}, {rows: [[0.05, 0.1, 1]]})), 2);
  close(sum(make_plan(1, {continuous: true, rows: [[0, 0.1, 1], [0.1, 0.1, 1], [0.2, 0.1, 1]]})), 1);
});

// Stands in for an AudioParam: keeps what is scheduled, and gives the value at a time.
class Param {
  events = [];
  value = 0;
  setValueAtTime(value, at) { this.events.push({at, value}); }
  linearRampToValueAtTime(value, at) { this.events.push({at, value, ramp: true}); }
  setTargetAtTime(value, at) { this.events.push({at, value}); }
  cancelScheduledValues(from) { this.events = this.events.filter(e => e.at < from); }
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
  gains = [];
  places = [];
  oscillators = 0;
  destination = {};
  createGain() { const gain = new Param(); this.gains.push(gain); return {gain, connect: to => to}; }
  createStereoPanner() { const pan = new Param(); this.places.push(pan); return {pan, connect: to => to}; }
  createOscillator() { ++this.oscillators; return {frequency: this.frequency = new Param(), connect: to => to, start() {}}; }
  async resume() {}
  close() { this.closed = true; }
}

// Starts a plan on a context whose time goes by together with the timers'.
function start(t, plan, at_s, options = {}) {
  const context = new Context(), timers = [];
  const add = repeats => (call, ms) => timers.push({call, repeats, s: ms / 1000, due_s: context.currentTime + ms / 1000});
  t.mock.method(globalThis, "setInterval", add(true));
  t.mock.method(globalThis, "setTimeout", add(false));
  t.mock.method(globalThis, "clearInterval", number => { timers[number - 1].due_s = Infinity; });
  const sound = start_loudspeaker(plan, at_s, {context, ...options});
  const pass = seconds => {
    for (let i = 0; i < 20 * seconds; ++i) {
      context.currentTime += 0.05;
      for (const timer of timers.filter(each => each.due_s <= context.currentTime)) {
        timer.due_s = timer.repeats ? context.currentTime + timer.s : Infinity;
        timer.call();
      }
    }
  };
  return {context, sound, pass, gain: (tactor, t_s) => context.gains[1 + tactor].at(7.05 + t_s - at_s)};
}

test("tactors are places between left and right", t => {
  const {context} = start(t, make_plan(3, {rows: [[0, 0.1, 1, 1, 1]]}), 0, {carrier_hz: 300});
  assert.deepEqual(context.places.map(p => p.value), [-1, 0, 1]);
  assert.equal(context.frequency.value, 300);
  assert.deepEqual(start(t, make_plan(1, {rows: [[0, 0.1, 1]]}), 0).context.places.map(p => p.value), [0]);
});

test("the sum is well below full scale, and a gain lowers it only", t => {
  for (const [gain, largest] of [[undefined, 0.25], [0.1, 0.025], [4, 0.25]])
    close(start(t, make_plan(3, {rows: [[0, 0.1, 1, 1, 1]]}), 0, {gain}).context.gains[0].at(8) * 3, largest);
});

test("ten minutes are scheduled bit by bit on the same few nodes, from the middle, too", t => {
  const plan = make_plan(1, {rows: Array.from({length: 6000}, (_, i) => [i * 0.1, 0.05, i % 10 / 10])});
  const {context, sound, pass, gain} = start(t, plan, 100.02);
  assert.equal(context.gains.length + context.oscillators, 3);
  assert.equal(sound.now_s(), 100.02);
  close(gain(0, 100.32), 0.3);
  assert.ok(context.gains[1].events.length < 300);
  pass(300);
  close(sound.now_s(), 400.02 - 0.05);
  for (const at of [400.12, 400.92, 401.32]) close(gain(0, at), Math.round(10 * at - 0.2) % 10 / 10, at);
  for (const at of [400.07, 400.97]) close(gain(0, at), 0, at);
});

test("a tone goes on from slice to slice, but not if the page gets no time", t => {
  const {context, pass, gain} = start(t, make_plan(1, {rows: [[0, 30, 1]]}), 0);
  pass(3);
  for (let at = 0.01; at < 5; at += 0.001) close(gain(0, at), 1, at);
  context.currentTime += 10;
  close(gain(0, 13), 0);
  pass(1);
  close(gain(0, 14.5), 1);
});

test("it ends by itself and says so", t => {
  let ended = 0;
  const {context, sound, pass} = start(t, make_plan(1, {rows: [[0, 0.5, 1]]}), 0, {ended: () => ++ended});
  pass(0.5);
  assert.equal(ended, 0);
  pass(1);
  assert.deepEqual([ended, context.closed, sound.now_s()], [1, true, 0.5]);
  sound.stop();
  assert.equal(ended, 1);
});

test("stop fades and ends it at once", t => {
  let ended = 0;
  const {context, sound, pass} = start(t, make_plan(1, {rows: [[0, 5, 1]]}), 0, {ended: () => ++ended});
  pass(1);
  sound.stop();
  assert.equal(context.gains[0].at(context.currentTime), 0);
  const scheduled = context.gains[1].events.length;
  pass(3);
  assert.deepEqual([ended, context.closed, context.gains[1].events.length], [0, true, scheduled]);
});
