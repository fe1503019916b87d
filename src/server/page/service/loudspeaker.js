// SPDX-License-Identifier: MIT
// A plan on the browser's loudspeakers (Web Audio): each tactor is a place between left and right.

const ENVELOPE_S = 0.005;
const AHEAD_S = 2.5;      // time by which gains are scheduled ahead; browsers call the timers of a hidden page once a second
const CHECK_S = 0.25;
const START_S = 0.05;
const LEVEL = 0.25;       // the largest sample, full scale 1
const CARRIER_HZ = 250;
const LOW_HZ = 330, HIGH_HZ = 880; // frequencies of places, from bottom to top

// Starts a plan of the view "percept" at a moment, on an array's tactors, [{x_mm, y_mm}, ...]. With `pitched` each tactor has a frequency by its
// place. Call it from a user's gesture: browsers allow sound only then. Returns {stop(), set_gain(gain)}; a gain is at most 1.
export function start_loudspeaker(plan, tactors, at_s, {gain = 1, pitched = false, context = new AudioContext()} = {}) {
  const begin = context.currentTime + START_S, offset_s = begin - at_s;
  const master = context.createGain(), largest = Math.max(1, largest_sum(plan));
  const level = v => LEVEL * Math.min(1, v) / largest;
  master.gain.value = level(gain);
  master.connect(context.destination);
  const places = make_places(context, tactors, pitched, master);
  const strokes = plan.strokes.map(s => make_stroke(context, plan, s, places));
  const schedule = () => strokes.forEach(s => {
    for (; s.next < s.end && plan.onsets[s.next] + offset_s < context.currentTime + AHEAD_S; s.next += s.every) {
      const onset = plan.onsets[s.next] + offset_s, from = Math.max(begin, onset), to = onset + s.every * plan.durations[s.next];
      if (to <= begin) continue;
      const begins = from === begin || s.next === s.first, ends = s.next + s.every >= s.end;
      for (const [k, param] of s.gains) {
        const amplitude = plan.amplitudes[s.next * plan.tactors + k];
        if (s.continuous) schedule_curve(param, amplitude, from, to, begins, ends); else schedule_burst(param, amplitude, from, to);
      }
    }
  });
  const timer = setInterval(schedule, 1000 * CHECK_S);
  resume(context);
  schedule();
  return {
    set_gain(v) { master.gain.setTargetAtTime(level(v), context.currentTime, ENVELOPE_S); },
    stop() {
      clearInterval(timer);
      master.gain.setTargetAtTime(0, context.currentTime, ENVELOPE_S / 3);
      setTimeout(() => context.close(), 100);
    },
  };
}

// Starts a sound whose gains can be changed while it plays. Returns {set(gains, level), stop()}; a level is at most 1.
export function start_tones(tactors, context = new AudioContext()) {
  const gains = make_places(context, tactors, true, context.destination).map(place => add_gain(context, place));
  const set = (parts, level) => gains.forEach((gain, i) => gain.setTargetAtTime(parts[i] * LEVEL * Math.min(1, level)
    / Math.max(1, parts.reduce((sum, v) => sum + v)), context.currentTime, ENVELOPE_S));
  resume(context);
  return {set, stop() { set(tactors.map(() => 0), 0); setTimeout(() => context.close(), 100); }};
}
function resume(context) { context.resume().catch(() => {}); } // stopped before it could start

// Makes an oscillator and a panner for each tactor; without `pitched` all have one oscillator.
function make_places(context, tactors, pitched, out) {
  const oscillator = hz => { const o = context.createOscillator(); o.frequency.value = hz; o.start(); return o; };
  const carrier = pitched ? null : oscillator(CARRIER_HZ);
  const ys = tactors.map(t => t.y_mm), below = Math.max(...ys), height = below - Math.min(...ys);
  const xs = tactors.map(t => t.x_mm), left = Math.min(...xs), width = Math.max(...xs) - left;
  return tactors.map(({x_mm, y_mm}) => {
    const panner = context.createStereoPanner();
    panner.pan.value = width > 0 ? 2 * (x_mm - left) / width - 1 : 0;
    panner.connect(out);
    return {panner, oscillator: carrier ?? oscillator(LOW_HZ * (HIGH_HZ / LOW_HZ) ** (height > 0 ? (below - y_mm) / height : 0.5))};
  });
}
// Adds a gain to a place, which is silent; several of them add up.
function add_gain(context, {oscillator, panner}) {
  const gain = context.createGain();
  gain.gain.value = 0;
  oscillator.connect(gain).connect(panner);
  return gain.gain;
}

// Returns the rows of a stroke to schedule, and the gains of the tactors on which it plays, [[tactor, gain], ...].
function make_stroke(context, plan, {first, count, continuous}, places) {
  const end = first + count, used = new Set();
  for (let i = first * plan.tactors; i < end * plan.tactors; ++i) if (plan.amplitudes[i] > 0) used.add(i % plan.tactors);
  // Uses only every n-th row of a curve with many rows.
  const every = continuous ? Math.max(1, Math.ceil(ENVELOPE_S / plan.durations[first])) : 1;
  return {first, next: first, end, every, continuous, gains: [...used].map(k => [k, add_gain(context, places[k])])};
}
// Schedules a burst's rise and fall within its duration.
function schedule_burst(param, amplitude, from, to) {
  if (!amplitude) return;
  const envelope = Math.min(ENVELOPE_S, (to - from) / 2);
  param.setValueAtTime(0, from);
  param.linearRampToValueAtTime(amplitude, from + envelope);
  param.setValueAtTime(amplitude, to - envelope);
  param.linearRampToValueAtTime(0, to);
}
// Schedules a curve up to the middle of a row; it is linear between the middles.
function schedule_curve(param, amplitude, from, to, begins, ends) {
  if (begins) param.setValueAtTime(0, from);
  param.linearRampToValueAtTime(amplitude, (from + to) / 2);
  if (ends) param.linearRampToValueAtTime(0, to);
}

// Returns the largest sum of the tactors' amplitudes at any time: they share a carrier, and may all be on one side.
function largest_sum({onsets, durations, amplitudes, tactors}) {
  const changes = onsets.flatMap((onset, row) => {
    const sum = amplitudes.slice(row * tactors, (row + 1) * tactors).reduce((a, b) => a + b, 0);
    return [[onset, sum], [onset + durations[row] - 1e-6, -sum]]; // consecutive rows do not add up
  });
  changes.sort((a, b) => a[0] - b[0]);
  let now = 0;
  return changes.reduce((largest, [, change]) => Math.max(largest, now += change), 0);
}
