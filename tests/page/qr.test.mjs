// SPDX-License-Identifier: MIT
import assert from "node:assert/strict";
import {createHash} from "node:crypto";
import {test} from "node:test";
import {make_qr} from "../../src/server/page/takes/qr.js";

const TEXT = "http://192.168.1.7:8080/#token=" + "0123456789abcdef".repeat(12);
// Of each version: bytes, mask, and the SHA-256 of the rows that segno makes (without its padding fault of 1.4.1) and qrencode, too.
const SYMBOLS = [
  [14, 1, "dc4f450ee6a44455"], [24, 2, "d24b110bf3d37e4f"], [40, 3, "9c1f570c84a927d6"], [60, 4, "f94bd586ff54f3a8"],
  [80, 5, "2095431265b1965d"], [100, 6, "68435b3f81b56f79"], [120, 7, "5edbf4f16e90921e"], [150, 0, "1e22661dafb510c9"],
  [180, 1, "855bd54b469a09cf"], [213, 2, "36993d9e0840c7d0"]];

function rows({size, dark}) {
  return Array.from({length: size}, (_, row) => Array.from({length: size}, (_, column) => Number(dark(row, column))).join(""));
}

test("a symbol of each version and mask is that of other programs", () => {
  SYMBOLS.forEach(([bytes, mask, hash], i) => {
    const symbol = make_qr(TEXT.slice(0, bytes), mask);
    assert.equal(symbol.size, 21 + 4 * i);
    assert.equal(createHash("sha256").update(rows(symbol).join("\n")).digest("hex").slice(0, 16), hash, `version ${i + 1}`);
  });
});

test("the mask is the one that qrencode chooses", () => {
  assert.deepEqual(rows(make_qr("tactor 4cc71bb")), `
    111111101011101111111 100000101100101000001 101110100111101011101 101110101001101011101 101110100111001011101
    100000100100001000001 111111101010101111111 000000001011100000000 101101110010001001011 001000011100010010101
    000100111100001000011 010011010010100011010 011101100010101100010 000000001101101011010 111111101111001011100
    100000101101110111101 101110100101000000110 101110101111110101010 101110101100111000100 100000100000101110001
    111111101101001100100`.trim().split(/\s+/));
});

test("the smallest version that holds the text is taken", () => {
  for (const [bytes, size] of [[0, 21], [14, 21], [15, 25], [62, 33], [63, 37], [180, 53], [181, 57], [213, 57]])
    assert.equal(make_qr("x".repeat(bytes)).size, size, `${bytes} bytes`);
  assert.equal(make_qr("é".repeat(7)).size, 21); // counts bytes, not letters
  assert.equal(make_qr("é".repeat(8)).size, 25);
});

test("a text that is too long is refused", () => {
  assert.throws(() => make_qr("x".repeat(214)), {name: "RangeError", message: /214 bytes/});
});
