// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {make_key_guard} from "../../src/study/session/page/key_guard.js";

test("a key that is pressed twice or held begins no text", () => {
  const guard = make_key_guard();
  assert.equal(guard("3", 5000), false); // it answers
  assert.equal(guard("3", 5200), true);
  for (let at = 5233; at < 9000; at += 33) assert.equal(guard("3", at), true); // held
  assert.equal(guard("3", 10100), false);
  assert.equal(guard("4", 10110), false); // another one is meant
  assert.equal(guard("3", 10120), false);
});
