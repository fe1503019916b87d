// SPDX-License-Identifier: MIT
// Storage without IndexedDB, which Node.js does not have; test_modules_in_browser.py tries it in a browser.
import assert from "node:assert/strict";
import {test} from "node:test";
import {open_storage} from "../../src/server/page/takes/storage.js";

test("a database that is refused, at once or later, is told", async () => {
  for (const indexedDB of [undefined, {open: () => { throw new Error("SecurityError"); }}, {open: () => {
    const asked = {error: new Error("InvalidStateError")};
    queueMicrotask(() => asked.onerror());
    return asked;
  }}]) {
    globalThis.indexedDB = indexedDB;
    await assert.rejects(open_storage("takes"));
  }
});
