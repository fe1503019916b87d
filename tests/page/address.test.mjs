// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {test} from "node:test";
import {is_own_host} from "../../src/server/page/takes/address.js";

test("an address is shared only where another machine can open it", () => {
  for (const own of ["localhost:4003", "studio.localhost", "127.0.0.1:4003", "127.1", "0.0.0.0:4003", "[::1]:4003", "[::]", "[::ffff:127.0.0.1]"])
    assert.ok(is_own_host(new URL(`http://${own}/`).hostname), own);
  for (const other of ["192.168.1.7:4003", "lab:4003", "localhost.lab.org", "[fe80::1]", "[::ffff:192.168.1.7]", "[::12]"])
    assert.ok(!is_own_host(new URL(`http://${other}/`).hostname), other);
});
