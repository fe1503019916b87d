// SPDX-License-Identifier: MIT
// Names and sentences for people, instead of the identifiers of files and options.

export const ALGORITHMS = {
  "park2016": ["Park 2016", "Short bursts that touch but do not overlap, on three tactors at a time. Follows any path."],
  "tactile-brush": ["Tactile Brush", "Bursts where the path crosses lines of the grid, timed to overlap. From 2011, for comparison."],
  "continuous": ["Continuous", "One vibration without bursts; each tactor gets stronger and weaker along the path."],
};
export const PHANTOMS = {
  "inverse-distance": ["Inverse distance", "As Park published it. Constant energy; jumps a little from triangle to triangle."],
  "barycentric": ["Barycentric", "Within each triangle, the energies balance exactly at the point."],
  "linear": ["Linear", "Amplitudes fall evenly with the distance to each tactor."],
  "log": ["Logarithmic", "Amplitudes fall with the logarithm of the distance."],
  "gaussian": ["Gaussian", "All tactors near the point play, the nearest most."],
};
export const OPTION_NAMES = {
  faces: "Tactors for each point", compensate: "Correct the predicted error", sigma_mm: "Uncertainty of position",
  sigma_v_mm_s: "Spread of speeds", outside: "Beyond the array", snap: "Move ends onto the grid", drop_points: "Drop crossings",
  overlap: "Where bursts overlap", soa: "Interval, onset to onset (SOA)", burst: "Burst", slope: "Slope of the law",
  intercept: "Intercept of the law", timing: "Interval", min_duration: "Shortest burst", carrier: "Carrier", am: "Amplitude modulation",
  noise_seed: "Seed of the noise", ramp: "Ramp", envelope: "Envelope", attack: "Attack", release: "Release", sl: "Level above the threshold",
  intensity_scale: "Scale of strength", stevens_exponent: "Exponent of felt strength", level_dbfs: "Level", phase: "One carrier for the whole stroke",
};
// Words for a prediction: its distance from the path as a part of the pitch, its lag, and the coefficient of variation of its speed.
export const path_word = part => part < 0.03 ? "on the path" : part < 0.1 ? "near the path" : "off the path";
export const lag_word = s => s >= 0.0005 ? `late by ${Math.round(1000 * s)} ms` : "on time";
export const even_word = cv => cv < 0.25 ? "even" : cv < 0.5 ? "slightly uneven" : "uneven";
// Returns a number and a word: the distance from the path, and how even the speed is; empty if neither is predicted.
export const short_facts = ({rms_to_path_mm: mm, speed_cv: cv}) => [typeof mm === "number" && `${number_text(mm)} mm from the path`,
  typeof cv === "number" && even_word(cv)].filter(Boolean).join(", ");
// Returns names and values of all errors of a prediction, without those that it does not have.
export function error_facts(e) {
  const mm = v => `${number_text(v)} mm`, has = v => typeof v === "number";
  const part = (rms, most) => has(rms) && `${mm(rms)} RMS, at most ${mm(most)}`;
  return Object.entries({
    "To the path": has(e.rms_to_path_mm) && `${mm(e.rms_to_path_mm)} RMS, to its nearest point`,
    "At equal times": part(e.rms_error_mm, e.largest_error_mm),
    "Along the path": part(e.along_rms_mm, e.along_max_mm),
    "Across it": part(e.across_rms_mm, e.across_max_mm),
    "Lag": has(e.lag_s) && `${lag_word(e.lag_s)}${e.lag_s > 0 ? `; without the lag ${mm(e.rms_at_lag_mm)} RMS` : ""}`,
    "Speed": has(e.speed_cv) && `${even_word(e.speed_cv)}: its standard deviation is ${number_text(e.speed_cv, 2)} of its mean (CV)`,
  }).filter(([, text]) => text);
}
export const facts_text = e => e && !e.refused ? error_facts(e).map(fact => fact.join(": ")).join("\n") : "";
export function seconds_text(s) {
  if (s < 59.995) return `${s.toFixed(2)} s`;
  const tenths = Math.round(s * 10);
  return `${Math.floor(tenths / 600)} min ${((tenths % 600) / 10).toFixed(1)} s`;
}
export const number_text = (v, digits = 1) => v.toFixed(digits).replace("-", "−");
// Writes an identifier as words: "tactile-brush" becomes "Tactile brush".
export const plain_name = id => (id.charAt(0).toUpperCase() + id.slice(1)).replace(/[-_]/g, " ");
export const array_name = a => ({"palm-3x3": "Palm, 3 × 3", "palm-2x4": "Palm, 2 × 4", dualsense: "DualSense", "usb-7.1": "USB 7.1"})[a?.name]
  ?? (a?.name ? plain_name(a.name) : "Array");

const SHORT_HINT = 80; // most characters of a hint; a file has room for no more
// Parameters that contain strokes, or limits whose text needs no name.
const OF_PROTOCOL = /^(toml|text|base64|points|params|stream|bursts|max_\w+|export|import)?$/;
const option_name = name => OPTION_NAMES[name] ?? plain_name(name);
// Returns a fault, of the service or of this page, in words for people: without terms of the protocol and without a full stop.
export function fault_text({message, data}) {
  const {what = "", why, hint, line} = data ?? {}, plain = text => text.replace(/\boptions\.(\w+)/g, (_, name) => `“${option_name(name)}”`);
  if (!why) return message;
  if (/off the lines of the grid/.test(why)) return "the Tactile Brush begins and ends on lines of the grid, and this stroke does not";
  const about = line ? `line ${line}` : OF_PROTOCOL.test(what) ? "" : option_name(what.replace(/^options\./, ""));
  return `${about && `${about}: `}${plain(why)}${hint && !(line && hint.length > SHORT_HINT) ? ` (${plain(hint)})` : ""}`;
}
export function fault_sentence(e) {
  const text = fault_text(e);
  return `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;
}
