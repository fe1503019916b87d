// SPDX-License-Identifier: MIT
// Takes kept by the browser, in IndexedDB, because localStorage holds 5 MB only.

// Opens the named storage. Rejects if the browser has none, as in some private windows. Resolves to
//   load(): resolves to all takes, in the order of their ids; a take is any object with an `id`, and a `version` or none
//   get(key): resolves to a value
//   write({takes, removed, values}, known): replaces takes, removes those with the ids `removed`, and sets the values of
//     an object; undefined removes one. With `known`, a map of versions by id, a kept take of another version, from
//     another tab, is not replaced; resolves to these.
// A write resolves when the browser has accepted the data, and rejects when it does not (a full disk, say).
// Calls on_gone when the browser or another page takes the storage away.
export async function open_storage(name, on_gone = () => {}) {
  const database = await open_database(name);
  // Lets another page change or delete the database.
  database.onversionchange = () => { database.close(); on_gone(); };
  database.onclose = on_gone;
  // Resolves to what `ask` returns, once its requests are done; they are done even if the page closes at once.
  const transact = (mode, ask) => new Promise((done, failed) => {
    const transaction = database.transaction(["takes", "values"], mode);
    const asked = ask(transaction.objectStore("takes"), transaction.objectStore("values"));
    transaction.oncomplete = () => done(asked);
    transaction.onabort = () => failed(transaction.error ?? new Error("the browser's storage failed"));
    transaction.commit();
  });
  return {
    load: async () => (await transact("readonly", all => all.getAll())).result,
    get: async key => (await transact("readonly", (_, values) => values.get(key))).result,
    write: async ({takes = [], removed = [], values = {}}, known) => {
      const kept = known ? await transact("readonly", all => takes.map(t => all.get(t.id))) : [];
      const others = kept.map(a => a.result).filter((k, i) => k && k.version !== known.get(k.id) && k.version !== takes[i].version);
      await transact("readwrite", (all, kept_values) => {
        for (const t of takes) if (!others.some(k => k.id === t.id)) all.put(t);
        removed.forEach(id => all.delete(id));
        for (const [key, v] of Object.entries(values)) if (v === undefined) kept_values.delete(key); else kept_values.put(v, key);
      });
      return others;
    },
  };
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
