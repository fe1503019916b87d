// SPDX-License-Identifier: MIT
// A stroke on the browser's loudspeakers (Web Audio): each tactor is a place between left and right.

const SOUND_ENVELOPE_S = 0.005;
const SOUND_SLICE_S = 1;
const SOUND_AHEAD_S = 2.5;   // gains are scheduled so far ahead; browsers call the timers of a hidden page once a second
const SOUND_CHECK_S = 0.25;
const SOUND_START_S = 0.05;
const SOUND_LEVEL = 0.25;    // the largest sample, full scale 1
const LOW_HZ = 330, HIGH_HZ = 880; // of places, from below to above

// Starts at a time of the plan and returns {stop(), now_s(), set_gain(gain)}; now_s() is the time of the plan that is heard.
// Call it from a user's gesture: browsers allow sound only then.
//   plan: what the method `plan` gives for the view "bursts", and its `places`: the array's tactors, [{x_mm, y_mm}, ...]
//   options: carrier_hz (250); pitched: each tactor has a frequency by its place instead; gain (1, at most); ended, called at the
//   end of the plan, but not after stop(); context, the AudioContext
export function start_loudspeaker(plan, at_s = 0, options = {}) {
  const context = options.context ?? new AudioContext();
  const ramps = plan_ramps(plan), slices = ramps_by_slice(ramps);
  const begin = context.currentTime + SOUND_START_S;
  const master = context.createGain();
  master.gain.setValueAtTime(0, begin);
  const largest = largest_sum(plan, ramps), level = gain => SOUND_LEVEL * Math.min(1, gain) / Math.max(1, largest);
  master.gain.linearRampToValueAtTime(level(options.gain ?? 1), begin + SOUND_ENVELOPE_S);
  master.connect(context.destination);
  const gains = connect_places(context, plan.places, options.pitched ? 0 : options.carrier_hz ?? 250, master);
  const elapsed_s = () => at_s + context.currentTime - begin;
  let next_s = at_s, stopped = false;
  const stop = () => {
    if (stopped) return;
    stopped = true;
    clearInterval(timer);
    master.gain.cancelScheduledValues(0);
    master.gain.setTargetAtTime(0, context.currentTime, SOUND_ENVELOPE_S / 3);
    setTimeout(() => context.close(), 100);
  };
  const schedule = () => {
    while (next_s < plan.total_s && next_s < elapsed_s() + SOUND_AHEAD_S) {
      const slice = Math.floor(next_s / SOUND_SLICE_S), until_s = (slice + 1) * SOUND_SLICE_S;
      slice_gains(plan, slices[slice] ?? [], next_s, until_s)
        .forEach((points, tactor) => schedule_gains(gains[tactor], points, begin - at_s));
      next_s = until_s;
    }
    if (elapsed_s() > plan.total_s + SOUND_START_S) {
      stop();
      options.ended?.();
    }
  };
  const timer = setInterval(schedule, 1000 * SOUND_CHECK_S);
  context.resume().catch(() => {}); // stopped before it could start
  schedule();
  const set_gain = gain => { if (!stopped) master.gain.setTargetAtTime(level(gain), context.currentTime, SOUND_ENVELOPE_S); };
  return {stop, set_gain, now_s: () => Math.min(plan.total_s, Math.max(at_s, elapsed_s() - (context.outputLatency || 0)))};
}

// Starts a sound whose tactors are given gains as it goes on: set(gains, level), with a level of at most 1, and stop().
export function start_tones(places, context = new AudioContext()) {
  const gains = connect_places(context, places, 0, context.destination);
  const set = (parts, level) => gains.forEach((gain, i) => gain.setTargetAtTime(parts[i] * SOUND_LEVEL * Math.min(1, level)
    / Math.max(1, parts.reduce((sum, v) => sum + v)), context.currentTime, SOUND_ENVELOPE_S));
  context.resume().catch(() => {}); // stopped before it could start
  return {set, stop() { set(places.map(() => 0), 0); setTimeout(() => context.close(), 100); }};
}

// Connects one oscillator through a gain and a panner for each tactor; returns the gains. Without a carrier each tactor has an
// oscillator of a frequency by its place.
function connect_places(context, places, carrier_hz, master) {
  const oscillator = hz => { const o = context.createOscillator(); o.frequency.value = hz; o.start(); return o; };
  const carrier = carrier_hz && oscillator(carrier_hz);
  const ys = places.map(p => p.y_mm), below = Math.max(...ys), height = below - Math.min(...ys);
  const xs = places.map(p => p.x_mm), left = Math.min(...xs), width = Math.max(...xs) - left;
  return places.map(({x_mm, y_mm}) => {
    const gain = context.createGain(), panner = context.createStereoPanner();
    gain.gain.value = 0;
    panner.pan.value = width > 0 ? 2 * (x_mm - left) / width - 1 : 0;
    (carrier || oscillator(LOW_HZ * (HIGH_HZ / LOW_HZ) ** (height > 0 ? (below - y_mm) / height : 0.5))).connect(gain).connect(panner).connect(master);
    return gain.gain;
  });
}

// Schedules the gains of a slice. A page that gets no time for the next slice falls silent; the next slice takes that back.
function schedule_gains(gain, points, offset_s) {
  if (!points.length) return;
  const [[first_s, first], ...others] = points;
  gain.cancelScheduledValues(offset_s + first_s + SOUND_ENVELOPE_S / 2);
  gain.setValueAtTime(first, offset_s + first_s);
  for (const [t_s, value] of others) gain.linearRampToValueAtTime(value, offset_s + t_s);
  gain.linearRampToValueAtTime(0, offset_s + points.at(-1)[0] + SOUND_ENVELOPE_S);
}

// Returns {row, times} for rows of a plan: the gain rises from times[0] to [1] and falls from [2] to [3]. A burst has the
// envelope at both ends; a curve is linear between the middles of its rows, and has the envelope where it begins and ends.
export function plan_ramps(plan) {
  return plan.strokes.flatMap(({first, count, continuous}) => {
    // A curve with many rows is taken at every few.
    const every = continuous && count > 0 ? Math.max(1, Math.ceil(SOUND_ENVELOPE_S / plan.durations[first])) : 1;
    const ramps = [];
    for (let row = first; row < first + count; row += every) {
      const from = plan.onsets[row], length = every * plan.durations[row], to = from + length, middle = from + length / 2;
      if (!(length > 0)) continue;
      const envelope = Math.min(SOUND_ENVELOPE_S, length / 2);
      const begins = !continuous || row === first, ends = !continuous || row + every >= first + count;
      ramps.push({row, times: [begins ? from : middle - length, begins ? from + envelope : middle,
        ends ? to - envelope : middle, ends ? to : middle + length]});
    }
    return ramps;
  });
}

// Returns for each slice of a second the ramps that it needs; slices without any are missing.
export function ramps_by_slice(ramps) {
  const slices = [];
  for (const ramp of ramps)
    for (let i = Math.max(0, Math.floor(ramp.times[0] / SOUND_SLICE_S)); i * SOUND_SLICE_S < ramp.times[3]; ++i)
      (slices[i] ??= []).push(ramp);
  return slices;
}

// Returns the gains of each tactor from one time to another as [[t_s, gain], ...], linear between them, and [] for a silent tactor.
// Only ramps of the slice are needed. Strokes at once add up.
export function slice_gains(plan, ramps, from_s, to_s) {
  return Array.from({length: plan.tactors}, (_, tactor) => {
    const turns = [];   // [time, change of the slope]
    for (const {row, times: [a, b, c, d]} of ramps) {
      const amplitude = plan.amplitudes[row * plan.tactors + tactor];
      if (amplitude > 0) turns.push([a, amplitude / (b - a)], [b, amplitude / (a - b)], [c, amplitude / (c - d)],
        [d, amplitude / (d - c)]);
    }
    if (!turns.length) return [];
    turns.push([from_s, 0], [to_s, 0]);
    turns.sort((x, y) => x[0] - y[0]);
    const points = [];
    let [before_s] = turns[0], gain = 0, slope = 0;
    for (const [t_s, change] of turns) {
      gain += slope * (t_s - before_s);
      slope += change;
      if (t_s >= from_s && t_s <= to_s && t_s !== points.at(-1)?.[0]) points.push([t_s, gain < 1e-6 ? 0 : gain]);
      before_s = t_s;
    }
    return points;
  });
}

// Returns the largest sum of the tactors' gains at any time: they have one carrier, and may all meet on one side.
export function largest_sum(plan, ramps) {
  const changes = ramps.flatMap(({row, times: [a, b, c, d]}) => {
    let sum = 0;
    for (let i = row * plan.tactors; i < (row + 1) * plan.tactors; ++i) sum += plan.amplitudes[i];
    return [[(a + b) / 2, sum], [(c + d) / 2, -sum]];
  });
  changes.sort((x, y) => x[0] - y[0] || x[1] - y[1]);
  let now = 0, largest = 0;
  for (const [, change] of changes) largest = Math.max(largest, now += change);
  return largest;
}
