// SPDX-License-Identifier: MIT
// The definition of a study of the two methods that are compared, for `tactor experiment`.
import {state, current_take, current_stroke, level_dbfs} from "../state.js";
import {by_id, listen, set_text} from "../../../net/page/dom.js";
import {with_side, request_options} from "./takes.js";
import {quoted, strokes_toml} from "./stroke.js";
import {file_name, give_toml} from "./files.js";

// Options of a method, see tactor-experiment(5).
const OF_METHOD = "algorithm phantom faces soa burst slope intercept timing min_duration outside snap drop_points overlap carrier".split(" ");
const form = by_id("study"), study_name = () => file_name({name: form.elements.name.value});

const table = (head, values) => `${head}\n${Object.entries(values).map(([k, v]) => `${k} = ${typeof v === "string" ? quoted(v) : v}\n`).join("")}`;
function definition(name) {
  const {question, trials} = form.elements, preset = /^palm-/.test(state.hello.array.name) && {array: state.hello.array.name};
  const methods = [0, 1].map(side => {
    const o = Object.entries(request_options(with_side(current_take(), side))).filter(([k, v]) => OF_METHOD.includes(k) && v !== undefined);
    return table("[[method]]", {name: `method ${side + 1}`, ...Object.fromEntries(o)});
  });
  return [`${table("[experiment]", {name, ...preset})}level = { dbfs = ${level_dbfs()} }\n`,
    table("[[motion]]", {name: current_stroke().name, file: `${name}-stroke.toml`}), ...methods,
    table("[[run]]", {name: "choice", task: "choose", attribute: "preference", simulate_as: "uniformity", question: question.value,
      trials: Math.round(trials.value) || 20})].join("\n");
}
const show_command = () => { set_text("study-command", `tactor experiment ${study_name()}.toml --participant P01 -o results`); };
listen("p-study", "beforetoggle", show_command);
listen(form, "input", show_command);
// The definition names the file of the stroke, which lies beside it.
listen(form, "submit", e => {
  e.preventDefault();
  const name = study_name();
  give_toml(`${name}-stroke`, strokes_toml([current_stroke()]));
  give_toml(name, definition(name));
});
