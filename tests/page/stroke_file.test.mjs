// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {read_take, rest_comment, strokes_toml, take_toml, with_level} from "../../src/server/page/takes/stroke_file.js";
import {as_drawn} from "../../src/server/page/takes/stroke.js";

const LINE = {name: "line", start_s: 0, timed: [[0, 5, 20, 1], [1, 35, 20, 1]]};
const ROWS = "algorithm phantom faces soa burst carrier waveform noise_seed am timing snap sl".split(" ").map(name => ({name}));
// Reads the keys of strokes as the service answers: of each value as it is written, in JSON's form.
const keys_of = text => text.split("[[stroke]]\n").slice(1).map(part => Object.fromEntries([...part.matchAll(/^(\w+) = (.*)$/gm)]
  .filter(([, key]) => !["name", "start_s", "start_from", "timed"].includes(key)).map(([, key, v]) => [key, JSON.parse(v)])));
const read = text => read_take({strokes: keys_of(text).map(keys => ({name: "line", start_s: 0, keys})), points: keys_of(text).map(() => LINE.timed)}, text, ROWS);

test("a take is written with its options, gain and mark, and read again with them", () => {
  for (const options of [{}, {algorithm: "continuous", phantom: "log", waveform: "noise:100-400", noise_seed: 7, am: "30:0.5"},
    {faces: "nearest", soa: 0.06, burst: 0.04, carrier: 200, waveform: "square", am: "30"}, {timing: "fit", snap: true, sl: 20}])
    for (const more of [{}, {gain_db: -6}, {leaves_array: true}]) {
      const {strokes, ...back} = read(take_toml({strokes: [LINE, LINE], options, ...more}));
      assert.deepEqual(back, {options, ...more});
      assert.deepEqual(strokes, [LINE, LINE]);
    }
});

test("what strokes of a file do not share stays theirs, under what is set for all", () => {
  const own = [{algorithm: "continuous", waveform: "noise:50-90", noise_seed: 3, level_db: -3}, {algorithm: "continuous", carrier_profile: [[0, 100], [1, 300]]}];
  const take = read(strokes_toml(own.map(keys => ({...LINE, keys}))));
  assert.deepEqual([take.options, take.gain_db], [{algorithm: "continuous"}, undefined]);
  assert.deepEqual(take.strokes.map(s => s.keys), own.map(({algorithm: _, ...keys}) => keys));
  assert.deepEqual(keys_of(take_toml({...take, gain_db: -2})), [{...own[0], level_db: -5}, {...own[1], level_db: -2}]);
  assert.deepEqual(keys_of(take_toml({...take, options: {carrier: 90, noise_seed: 8}})), [{waveform: "noise:50-90", noise_seed: 8, level_db: -3, carrier_hz: 90}, {carrier_hz: 90}]);
  assert.deepEqual(keys_of(take_toml({...take, options: {waveform: "square"}})), [{level_db: -3, waveform: "square"}, {carrier_profile: own[1].carrier_profile, waveform: "square"}]);
  assert.deepEqual(as_drawn({...take.strokes[0], ink: LINE.timed, knots: [{}]}).keys, take.strokes[0].keys);
});

test("a comment that somebody changed gives no option that is unknown, or of the file", () => {
  const text = say => `[stroke]\nalgorithm = "continuous"\n# Options of the studio that a stroke file has no keys for: ${say}\n`;
  const options = say => read_take({strokes: [{name: "a", start_s: 0, keys: {algorithm: "continuous"}}], points: [LINE.timed]}, text(say), ROWS).options;
  const own = {algorithm: "continuous"};
  assert.deepEqual(options('{"options":{"timing":"fit","colour":1,"snap":{"a":1},"sl":null,"algorithm":"park2016"}}'), {...own, timing: "fit"});
  for (const say of ["{", '{"options":3}', "{}"]) assert.deepEqual(options(say), own);
  assert.equal(rest_comment({options: {algorithm: "continuous"}}), "");
  assert.deepEqual(with_level({strokes: [LINE], options: {}}).strokes[0].keys, {});
});
