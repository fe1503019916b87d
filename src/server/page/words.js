// SPDX-License-Identifier: MIT Names and sentences for people, instead of the identifiers of files and options.

export const ALGORITHMS = {
  "park2016": ["Park 2016", "Short bursts that touch but do not overlap, on three tactors at a time. Follows any path."],
  "tactile-brush": ["Tactile Brush", "Bursts where the path crosses lines of the grid, timed to overlap. From 2011, for comparison."],
  "continuous": ["Continuous", "One vibration without bursts; each tactor gets stronger and weaker along the path."],
};
export const PHANTOMS = {
  "inverse-distance": ["Inverse distance", "As Park published it. Constant energy; jumps a little from triangle to triangle."],
  "barycentric": ["Barycentric", "The centre of the energies lies exactly at the point within each triangle."],
  "linear": ["Linear", "Amplitudes fall evenly with the distance to each tactor."],
  "log": ["Logarithmic", "Amplitudes fall with the logarithm of the distance."],
  "gaussian": ["Gaussian", "Each tactor reaches smoothly around itself, so its neighbours join in."],
};
export const OPTION_NAMES = {
  faces: "Tactors of a point", compensate: "Move bursts to where they are felt", sigma_mm: "Uncertainty of a place",
  sigma_v_mm_s: "Spread of speeds", outside: "Beyond the array", snap: "Move ends onto the grid", drop_points: "Drop crossings",
  overlap: "Where bursts overlap", soa: "Interval, onset to onset (SOA)", burst: "Burst", slope: "Slope of the law",
  intercept: "Intercept of the law", timing: "Interval", min_duration: "Shortest burst", carrier: "Carrier", am: "Amplitude modulation",
  noise_seed: "Seed of the noise", ramp: "Ramp", envelope: "Envelope", attack: "Attack", release: "Release", sl: "Level above the threshold",
  intensity_scale: "Scale of strength", stevens_exponent: "Exponent of felt strength", level_dbfs: "Level", phase: "One carrier through the stroke",
};
// Returns a word for an error, as a part of the pitch.
export const place_word = part => part < 0.06 ? "close to the path" : part < 0.15 ? "near the path" : "far from the path";
export const even_word = cv => cv < 0.25 ? "even speed" : cv < 0.5 ? "slightly uneven" : "uneven speed";
export function seconds_text(s) {
  if (s < 59.995) return `${s.toFixed(2)} s`;
  const tenths = Math.round(s * 10);
  return `${Math.floor(tenths / 600)} min ${((tenths % 600) / 10).toFixed(1)} s`;
}
export const number_text = (v, digits = 1) => v.toFixed(digits).replace("-", "−");
// Writes an identifier as words: "tactile-brush" becomes "Tactile brush".
export const plain_name = id => (id.charAt(0).toUpperCase() + id.slice(1)).replace(/[-_]/g, " ");
export const array_name = a => ({"palm-3x3": "Palm, 3 × 3", "palm-2x4": "Palm, 2 × 4"})[a?.name]
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
