// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {fits_entry} from "../../src/study/session/page/entry.js";

test("a whole number fits within its bounds, and nothing is left out of what was typed", () => {
  const fits = text => fits_entry(text, {lowest: 18, greatest: 99});
  for (const text of ["18", "99", "020"]) assert.ok(fits(text), text);
  for (const text of ["17", "100", "1.5", "-20", "2e1", "", "20b", "2,0"]) assert.ok(!fits(text), text);
});
test("any number above 0 is an estimate", () => {
  const fits = text => fits_entry(text, {lowest: 1e-9, greatest: 1e9, longest: 12});
  for (const text of ["0.5", "12.5", "1500", ".25", "7.", "1000000000", "0.000000001"]) assert.ok(fits(text), text);
  for (const text of ["0", "-1", "+1", "12,5", "1e5", "1e400", "nan", "Infinity", "", ".", "1.2.3", "1000000001", "1".repeat(40), "1." + "0".repeat(38)])
    assert.ok(!fits(text), text);
});
test("a text may be anything", () => assert.ok(fits_entry("", {most: 2000})));
