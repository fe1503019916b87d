// SPDX-License-Identifier: MIT
// Storage without IndexedDB, which Node.js does not have; test_storage.py tries it in a browser.
import assert from "node:assert/strict";
import {test} from "node:test";
import {open_storage} from "../../src/server/page/takes/storage.js";

test("without a database, takes are kept in memory, and the storage says so", async () => {
  const refusing = {open: () => { throw new Error("SecurityError"); }};
  for (const indexedDB of [undefined, refusing]) {
    globalThis.indexedDB = indexedDB;
    const storage = await open_storage("takes");
    assert.equal(storage.lasting, false);
    assert.deepEqual(await storage.load(), {takes: [], current: undefined});
    const take = {id: 2, name: "second", points: [[0, 1, 2]]};
    await storage.save(take);
    await storage.save({id: 1, name: "first"});
    take.points.push([1, 2, 3]); // not saved
    await storage.set("current", 2);
    assert.deepEqual(await storage.load(),
      {takes: [{id: 1, name: "first"}, {id: 2, name: "second", points: [[0, 1, 2]]}], current: 2});
    await storage.save({id: 2, name: "again"});
    await storage.remove(1);
    await storage.remove(7);
    assert.deepEqual((await storage.load()).takes, [{id: 2, name: "again"}]);
    assert.equal(await storage.get("current"), 2);
    assert.equal(await storage.get("nothing"), undefined);
    await assert.rejects(storage.save({id: 3, stop() {}}), {name: "DataCloneError"});
  }
});

test("a database that is refused later is no database", async () => {
  globalThis.indexedDB = {open: () => {
    const asked = {error: new Error("InvalidStateError")};
    queueMicrotask(() => asked.onerror());
    return asked;
  }};
  assert.equal((await open_storage("takes")).lasting, false);
});
