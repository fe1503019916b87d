// SPDX-License-Identifier: MIT
// The definition of a study of two methods, for `tactor experiment`, and its files: the array, and each stroke of the
// take.
import {quoted, strokes_toml} from "../takes/stroke_file.js";

// Options of a method, see tactor-experiment(5), without the level in dBFS, which the experiment sets.
const OF_METHOD = ("algorithm phantom faces soa burst slope intercept timing min_duration outside snap drop_points overlap compensate sigma_mm " +
  "sigma_v_mm_s carrier waveform am noise_seed phase ramp envelope attack release intensity_scale stevens_exponent sl").split(" ");

const table = (head, values) => `${head}\n${Object.entries(values).filter(([, v]) => v !== undefined && v !== null)
  .map(([k, v]) => `${k} = ${typeof v === "string" ? quoted(v) : JSON.stringify(v)}\n`).join("")}`;
// Makes names distinct.
function distinct(names) {
  const used = new Set();
  return names.map(name => {
    let own = name;
    for (let i = 2; used.has(own); ++i) own = `${name} ${i}`;
    used.add(own);
    return own;
  });
}
// Names methods by their differences.
function method_names(methods) {
  const by = ["algorithm", "phantom"].find(name => methods[0][name] !== methods[1][name]);
  return methods.map((m, i) => by ? m[by] : ["first", "second"][i]);
}
const array_toml = ({name, site, up, tactors}) => [table("[array]", {name, site, up}),
  ...tactors.map(({tactor: _, rise_s, ...t}) => table("[[tactor]]", {...t, rise_ms: rise_s && 1000 * rise_s}))].join("\n");

// Returns the files, [[name without .toml, text], ...]; each stroke is a motion. `methods` are the options of both sides.
export function study_files({name, question, trials, level_dbfs, array, take, methods}) {
  const {strokes} = take, names = distinct(strokes[1] ? strokes.map(s => s.name) : [take.name]), called = method_names(methods);
  const files = strokes.map((_, i) => strokes[1] ? `${name}-stroke-${i + 1}` : `${name}-stroke`);
  const definition = [`${table("[experiment]", {name, array: `${name}-array.toml`})}level = { dbfs = ${level_dbfs} }\n`,
    ...names.map((motion, i) => table("[[motion]]", {name: motion, file: `${files[i]}.toml`})),
    ...methods.map((m, i) => table("[[method]]", {name: called[i], ...Object.fromEntries(Object.entries(m).filter(([k]) => OF_METHOD.includes(k)))})),
    table("[[run]]", {name: "choice", task: "choose", attribute: "preference", simulate_as: "uniformity", question, trials})];
  return [[`${name}-array`, array_toml(array)], ...strokes.map((s, i) => [files[i], strokes_toml([{...s, start_s: 0}])]), [name, definition.join("\n")]];
}
// Returns the command that runs the study on the device of the service.
export const study_command = (name, pcm) => `tactor experiment ${name}.toml --participant P01 -o results${!pcm || pcm === "null" ? ""
  : ` -D ${/^[\w.:,=@%+/-]+$/.test(pcm) ? pcm : `'${pcm.replace(/'/g, "'\\''")}'`}`}`;
