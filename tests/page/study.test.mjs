// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {study_files, study_command} from "../../src/server/page/settings/study.js";

const stroke = (name, start_s) => ({name, start_s, timed: [[0, 0, 0, 1], [1, 40, 0, 1]]});
const asked = (more = {}) => ({name: "mine", question: "Which?", trials: 20, level_dbfs: -12, array: {name: "row", site: "left palm", tactors: [
  {tactor: 0, x_mm: 0, y_mm: 0, channel: 3, polarity: 1, gain_db: 0, max_dbfs: 0, threshold_dbfs: null, rise_s: 0.02}]},
take: {name: "Take 1", strokes: [stroke("a", 0)]}, methods: [{algorithm: "park2016"}, {algorithm: "continuous", level_dbfs: -12}], ...more});

test("a study names its array, its stroke and what differs between the methods", () => {
  const [array, drawn, definition] = study_files(asked());
  assert.deepEqual([array[0], drawn[0], definition[0]], ["mine-array", "mine-stroke", "mine"]);
  assert.equal(array[1], '[array]\nname = "row"\nsite = "left palm"\n\n[[tactor]]\nx_mm = 0\ny_mm = 0\nchannel = 3\npolarity = 1\ngain_db = 0\nmax_dbfs = 0\nrise_ms = 20\n');
  assert.match(definition[1], /^\[experiment\]\nname = "mine"\narray = "mine-array\.toml"\nlevel = \{ dbfs = -12 \}\n\n\[\[motion\]\]\nname = "Take 1"\nfile = "mine-stroke\.toml"\n/);
  assert.match(definition[1], /\[\[method\]\]\nname = "park2016"\nalgorithm = "park2016"\n\n\[\[method\]\]\nname = "continuous"\nalgorithm = "continuous"\n\n\[\[run\]\]/);
  const by = methods => study_files(asked({methods})).at(-1)[1].match(/(?<=\[\[method\]\]\n)name = .*/g);
  assert.deepEqual(by([{algorithm: "continuous", phantom: "log"}, {algorithm: "continuous", phantom: "linear"}]), ['name = "log"', 'name = "linear"']);
  assert.deepEqual(by([{soa: 0.06}, {soa: 0.07}]), ['name = "first"', 'name = "second"']);
});

test("each stroke of a take is a motion with a name of its own", () => {
  const files = study_files(asked({take: {name: "Take 1", strokes: [stroke("a", 0), stroke("a", 2), stroke("a 2", 3)]}}));
  assert.deepEqual(files.map(([name]) => name), ["mine-array", "mine-stroke-1", "mine-stroke-2", "mine-stroke-3", "mine"]);
  assert.deepEqual(files.at(-1)[1].match(/(?<=\[\[motion\]\]\n)name = .*/g), ['name = "a"', 'name = "a 2"', 'name = "a 2 2"']);
  assert.match(files[2][1], /start_s = 0\n/);
});

test("the command names the device of the service", () => {
  assert.equal(study_command("mine", "hw:CARD=Tactor,DEV=0"), "tactor experiment mine.toml --participant P01 -o results -D hw:CARD=Tactor,DEV=0");
  assert.equal(study_command("mine", "it's"), "tactor experiment mine.toml --participant P01 -o results -D 'it'\\''s'");
  assert.equal(study_command("mine", "null"), study_command("mine"));
});
