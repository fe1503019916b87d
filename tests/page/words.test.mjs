// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {readFileSync, readdirSync} from "node:fs";
import {test} from "node:test";
import {fault_sentence, fault_text} from "../../src/server/page/words.js";

const fault = (what, why, hint = "", more = {}) => ({message: `${what}: ${why}`, data: {what, why, hint, ...more}});

test("a fault names options as the page does, and no parameter of the protocol", () => {
  for (const [e, text] of [
    [fault("options.level_dbfs", "-12 dBFS are more than the owner allows, -20 dBFS", "use a lower level"),
      "Level: -12 dBFS are more than the owner allows, -20 dBFS (use a lower level)."],
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
