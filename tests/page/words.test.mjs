// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {readFileSync, readdirSync} from "node:fs";
import {test} from "node:test";
import {error_facts, even_word, facts_text, fault_sentence, fault_text, lag_word, path_word} from "../../src/server/page/words.js";

const fault = (what, why, hint = "", more = {}) => ({message: `${what}: ${why}`, data: {what, why, hint, ...more}});

test("a fault names options as the page does, and no parameter of the protocol", () => {
  for (const [e, text] of [
    [fault("options.level_dbfs", "-12 dBFS is above the owner's limit of -20 dBFS", "use a lower level"),
      "Level: -12 dBFS is above the owner's limit of -20 dBFS (use a lower level)."],
    [fault("options.soa", "it is too short", "options.burst 0.05, or options.timing fit"), "Interval, onset to onset (SOA): it is too short (“Burst” 0.05, or “Interval” fit)."],
    [fault("toml", "the strokes are too strong together"), "The strokes are too strong together."],
    [fault("max_stroke_s", "it lasts 700 s, but a stroke may last at most 600 s", "draw less, or faster"), "It lasts 700 s, but a stroke may last at most 600 s (draw less, or faster)."],
    [fault("name", "it is blank"), "Name: it is blank."],
    [fault("toml", "its start is off the lines of the grid", "options.snap"), "The Tactile Brush begins and ends on lines of the grid, and this stroke does not."],
    [{message: "there is no connection to tactor", data: {}}, "There is no connection to tactor."], [new Error("it is a figure"), "It is a figure."]])
    assert.equal(fault_sentence(e), text);
  assert.equal(fault_text(fault("text", "unknown key 'x'", "one of ".padEnd(90, "x"), {line: 3})), "line 3: unknown key 'x'");
  assert.equal(fault_text(fault("text", "'zero' is not a number", "give a number", {line: 2})), "line 2: 'zero' is not a number (give a number)");
});

test("no module shows a fault in other words", () => {
  const folder = new URL("../../src/server/page/", import.meta.url);
  for (const name of readdirSync(folder, {recursive: true}).filter(n => n.endsWith(".js")))
    for (const line of readFileSync(new URL(name, folder), "utf8").split("\n"))
      assert.doesNotMatch(line, /(say|show|set_text)\(.*\.message|state\.fault = .*\.message/, name);
});

test("errors are said by what they mean, and the rest on demand", () => {
  // park2016-1 on palm-3x3 with inverse-distance, as `tactor compare` prints it.
  const e = {rms_error_mm: 2.094158, largest_error_mm: 5.352373, lag_s: 0.035, rms_at_lag_mm: 1.684544, along_rms_mm: 2.076332,
    along_max_mm: 5.285772, across_rms_mm: 0.272661, across_max_mm: 0.841733, rms_to_path_mm: 0.223959, speed_cv: 0.684962};
  assert.equal(path_word(e.rms_to_path_mm / 20), "on the path");
  assert.equal(lag_word(e.lag_s), "late by 35 ms");
  assert.equal(even_word(e.speed_cv), "uneven");
  assert.deepEqual([path_word(1 / 20), path_word(4 / 20), lag_word(0), even_word(0.3), even_word(0)],
    ["near the path", "off the path", "on time", "slightly uneven", "even"]);
  assert.deepEqual(Object.fromEntries(error_facts(e)), {"To the path": "0.2 mm RMS, to its nearest point",
    "At equal times": "2.1 mm RMS, at most 5.4 mm", "Along the path": "2.1 mm RMS, at most 5.3 mm", "Across it": "0.3 mm RMS, at most 0.8 mm",
    "Lag": "late by 35 ms; without the lag 1.7 mm RMS", "Speed": "uneven: its standard deviation is 0.68 of its mean (CV)"});
  // What is not predicted is not there: a touch at rest has no direction and no speed.
  assert.deepEqual(error_facts({rms_error_mm: 0, largest_error_mm: 0, lag_s: 0, rms_at_lag_mm: 0, along_rms_mm: null, rms_to_path_mm: 0, speed_cv: null})
    .map(([name]) => name), ["To the path", "At equal times", "Lag"]);
  assert.equal(facts_text({refused: true}), "");
});
