// SPDX-License-Identifier: MIT
// Takes kept by the browser: in IndexedDB, because localStorage holds 5 MB only, or in memory where there is none.

// Opens the storage of a name and resolves to
//   load(): resolves to {takes, current}: all takes in the order of their ids, and the value of the key "current"
//   save(take), remove(id): a take is any object with an `id`; one with the same id is replaced
//   get(key), set(key, value): anything else
//   lasting: false where all is lost with the page, as in some private windows
// Promises of writes resolve when the browser has accepted the data, and reject when it does not (a full disk, say).
export async function open_storage(name) {
  try {
    return database_storage(await open_database(name));
  } catch {
    return memory_storage();
  }
}

function open_database(name) {
  return new Promise((done, failed) => {
    const asked = globalThis.indexedDB.open(name, 1);
    asked.onupgradeneeded = () => {
      asked.result.createObjectStore("takes", {keyPath: "id"});
      asked.result.createObjectStore("values");
    };
    asked.onsuccess = () => done(asked.result);
    asked.onerror = () => failed(asked.error);
    asked.onblocked = () => failed(new Error("another page keeps an older version open"));
  });
}

function database_storage(database) {
  // A page that wants to change or delete the database is not held up; writes of this one are then refused.
  database.onversionchange = () => database.close();
  // Resolves to the results of the requests that `ask` makes, once they are written.
  const transact = (mode, ask) => new Promise((done, failed) => {
    const transaction = database.transaction(["takes", "values"], mode);
    const asked = ask(transaction.objectStore("takes"), transaction.objectStore("values"));
    transaction.oncomplete = () => done(asked.map(a => a.result));
    if (mode === "readwrite") transaction.commit(); // a page that goes away at once has written it nevertheless
    transaction.onabort = () => failed(transaction.error ?? new Error("the browser's storage gave up"));
  });
  return {
    lasting: true,
    load: async () => {
      const [takes, current] = await transact("readonly", (all, values) => [all.getAll(), values.get("current")]);
      return {takes, current};
    },
    save: async take => { await transact("readwrite", all => [all.put(take)]); },
    remove: async id => { await transact("readwrite", all => [all.delete(id)]); },
    get: async key => (await transact("readonly", (_, values) => [values.get(key)]))[0],
    set: async (key, value) => { await transact("readwrite", (_, values) => [values.put(value, key)]); },
  };
}

function memory_storage() {
  const takes = new Map(), values = new Map();
  const by_id = (a, b) => a.id < b.id ? -1 : 1;
  return {
    lasting: false,
    load: async () => structuredClone({takes: [...takes.values()].sort(by_id), current: values.get("current")}),
    save: async take => { takes.set(take.id, structuredClone(take)); },
    remove: async id => { takes.delete(id); },
    get: async key => structuredClone(values.get(key)),
    set: async (key, value) => { values.set(key, structuredClone(value)); },
  };
}
