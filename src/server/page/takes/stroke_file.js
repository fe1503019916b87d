// SPDX-License-Identifier: MIT
// A take as a stroke file: options as keys of the file, the gain as its level, and other options in a comment at its
// end.

const KEYS = {algorithm: "algorithm", phantom: "phantom", faces: "faces", soa: "soa_s", burst: "burst_s", carrier: "carrier_hz", waveform: "waveform"};
const REST = /^# Options of the studio that a stroke file has no keys for: (\{.*\})$/m;
const AM = /^([\d.]+)(?::([\d.]+))?$/; // HZ or HZ:DEPTH

export const quoted = text => `"${String(text).replace(/[\u0000-\u001f\u007f]/g, " ").replace(/[\\"]/g, "\\$&")}"`;
// Returns a stroke's own `keys`, as in a stroke file, such as {soa_s: 0.4}. Leaves out options that are set for all strokes, because those win.
export const keys_left = (s, options) => Object.fromEntries(Object.entries(s.keys ?? {}).filter(([key]) => key === "noise_seed"
  ? options.waveform === undefined : options[key.replace(/_(s|hz|depth|profile)$/, "")] === undefined)
  .map(([key, v]) => [key, key === "noise_seed" ? options.noise_seed ?? v : v]));
const own_keys = (s, options) => Object.entries(keys_left(s, options))
  .map(([key, v]) => `${key} = ${typeof v === "string" ? quoted(v) : JSON.stringify(v)}\n`).join("");
export function strokes_toml(strokes, options = {}) {
  const ordered = [...strokes].sort((a, b) => a.start_s - b.start_s);
  return ordered.map(s => `[[stroke]]\nname = ${quoted(s.name)}\nstart_s = ${+s.start_s.toFixed(4)}\nstart_from = "piece"\n` +
    `${own_keys(s, options)}timed = [${s.timed.map(p => `[${p.join(", ")}]`).join(", ")}]\n`).join("\n");
}
export const stroke_csv = s => "t_s,x_mm,y_mm,intensity\n" + s.timed.map(p => p.join(",")).join("\n") + "\n";

// Splits options into keys of a stroke file and the others.
function split({noise_seed, am, ...options}) {
  const keys = {}, rest = {}, depth = AM.exec(am ?? "");
  for (const [name, v] of Object.entries(options)) if (KEYS[name]) keys[KEYS[name]] = v; else rest[name] = v;
  if (noise_seed !== undefined) (/^noise/.test(options.waveform) ? keys : rest).noise_seed = noise_seed;
  if (depth) Object.assign(keys, {am_hz: +depth[1], am_depth: +(depth[2] ?? 1)}); else if (am !== undefined) rest.am = am;
  return {keys, rest};
}
// Returns a take with its gain moved to the level of each stroke.
export const with_level = ({gain_db = 0, ...take}) => ({...take, strokes: take.strokes.map(s => ({...s,
  keys: {...s.keys, ...gain_db && {level_db: gain_db + (s.keys?.level_db ?? 0)}}}))});
// Returns the comment of a take, or "".
export function rest_comment({options, leaves_array}) {
  const {rest} = split(options), said = {...Object.keys(rest).length && {options: rest}, ...leaves_array && {leaves_array}};
  return Object.keys(said).length ? `# Options of the studio that a stroke file has no keys for: ${JSON.stringify(said)}\n` : "";
}
// Writes a take as the service does.
export function take_toml(take) {
  const {keys} = split(take.options);
  return strokes_toml(with_level(take).strokes.map(s => ({...s, keys: {...keys_left(s, take.options), ...keys}}))) + rest_comment(take);
}
// Returns the strokes, options and gain of a file, from its text and from the strokes that the service read in it. Options that all strokes have
// become the take's.
export function read_take({strokes, points}, text, rows) {
  const own = strokes.map(s => ({...s.keys})), shared = key => own.every(k => k[key] === own[0][key]) ? own[0][key] : undefined;
  const options = {}, take = {options}, drop = key => own.forEach(k => { delete k[key]; });
  for (const [name, key] of [...Object.entries(KEYS), ["noise_seed", "noise_seed"]]) {
    const v = shared(key);
    if (v === undefined || key === "noise_seed" && !options.waveform) continue;
    options[name] = v;
    drop(key);
  }
  const hz = shared("am_hz"), depth = shared("am_depth");
  if (hz !== undefined && depth !== undefined) { options.am = depth === 1 ? `${hz}` : `${hz}:${depth}`; drop("am_hz"); drop("am_depth"); }
  if (shared("level_db") < 0) { take.gain_db = shared("level_db"); drop("level_db"); }
  try {
    const said = JSON.parse(REST.exec(text)?.[1] ?? "{}");
    if (said.leaves_array) take.leaves_array = true;
    for (const [name, v] of Object.entries(said.options ?? {})) if (rows.some(o => o.name === name) && /string|number|boolean/.test(typeof v)) options[name] ??= v;
  } catch { /* somebody wrote another comment */ }
  return {...take, strokes: points.map((timed, i) => ({name: strokes[i].name, start_s: strokes[i].start_s, timed,
    ...Object.keys(own[i]).length && {keys: own[i]}}))};
}
