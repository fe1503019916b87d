// SPDX-License-Identifier: MIT
// QR codes (ISO/IEC 18004) of text as bytes, at error level M, versions 1 to 10.

// Blocks of a version, and codewords for correction in each.
const QR_BLOCKS = [1, 1, 1, 2, 2, 4, 4, 4, 5, 5];
const QR_CHECKS = [10, 16, 26, 18, 24, 16, 18, 22, 22, 26];
const QR_MASKS = [
  (y, x) => (y + x) % 2, y => y % 2, (y, x) => x % 3, (y, x) => (y + x) % 3,
  (y, x) => ((y >> 1) + Math.floor(x / 3)) % 2, (y, x) => y * x % 2 + y * x % 3,
  (y, x) => (y * x % 2 + y * x % 3) % 2, (y, x) => ((y + x) % 2 + y * x % 3) % 2];

// Returns {size, dark(row, column)}. Throws RangeError for more than 213 bytes. Without a mask, chooses the best of the eight.
export function make_qr(text, mask) {
  const bytes = new TextEncoder().encode(text);
  const version = QR_BLOCKS.findIndex((_, i) => 4 + count_bits(i + 1) + 8 * bytes.length <= 8 * data_bytes(i + 1)) + 1;
  if (version === 0) throw new RangeError(`a text of ${bytes.length} bytes is too long for a QR code of version 10`);
  const symbol = draw_fixed_parts(version);
  draw_codewords(symbol, interleave(version, data_codewords(version, bytes)));
  const masked = (mask === undefined ? [0, 1, 2, 3, 4, 5, 6, 7] : [mask]).map(m => apply_mask(symbol, m));
  const penalties = masked.map(modules => penalty(symbol.size, modules));
  const modules = masked[penalties.indexOf(Math.min(...penalties))];
  return {size: symbol.size, dark: (row, column) => modules[row * symbol.size + column] === 1};
}

function count_bits(version) { return version < 10 ? 8 : 16; }
function all_bytes(version) {
  const alignments = version < 2 ? 0 : version < 7 ? 25 : 6 * 25 - 2 * 5;
  return (16 * version + 128) * version + 64 - alignments - (version < 7 ? 0 : 36) >> 3;
}
function data_bytes(version) { return all_bytes(version) - QR_BLOCKS[version - 1] * QR_CHECKS[version - 1]; }

// Returns the codewords of the text: mode 4, its length, its bytes, an end and padding.
function data_codewords(version, bytes) {
  const bits = [];
  const append = (value, count) => { while (count-- > 0) bits.push(value >> count & 1); };
  append(4, 4);
  append(bytes.length, count_bits(version));
  for (const b of bytes) append(b, 8);
  append(0, 4); // ends at a whole byte, because mode and length are 4 + 8 or 4 + 16 bits
  const words = [];
  for (let i = 0; i < bits.length; i += 8) words.push(parseInt(bits.slice(i, i + 8).join(""), 2));
  for (let pad = 0xec; words.length < data_bytes(version); pad ^= 0xec ^ 0x11) words.push(pad);
  return words;
}

// Multiplies in GF(256), modulo x^8 + x^4 + x^3 + x^2 + 1.
function gf_multiply(a, b) {
  let product = 0;
  for (let i = 7; i >= 0; --i) product = product << 1 ^ (product >> 7) * 0x11d ^ (b >> i & 1) * a;
  return product;
}

// Returns the remainder of data * x^count by the Reed-Solomon generator, the product of (x - 2^i).
function check_words(data, count) {
  const generator = Array(count).fill(0);
  generator[count - 1] = 1;
  for (let i = 0, root = 1; i < count; ++i, root = gf_multiply(root, 2))
    for (let j = 0; j < count; ++j) generator[j] = gf_multiply(generator[j], root) ^ (generator[j + 1] ?? 0);
  const rest = Array(count).fill(0);
  for (const word of data) {
    const factor = word ^ rest.shift();
    rest.push(0);
    generator.forEach((g, i) => { rest[i] ^= gf_multiply(g, factor); });
  }
  return rest;
}

// Splits data into the version's blocks, short ones first, and takes a codeword of each in turn: data, then checks.
function interleave(version, data) {
  const count = QR_BLOCKS[version - 1], short = Math.floor(data.length / count), longer = data.length % count;
  const blocks = [];
  for (let i = 0, at = 0; i < count; ++i) {
    const length = short + (i >= count - longer ? 1 : 0);
    blocks.push(data.slice(at, at += length));
  }
  const checks = blocks.map(b => check_words(b, QR_CHECKS[version - 1]));
  const in_turn = all => Array.from({length: Math.max(...all.map(b => b.length))}, (_, i) => all.map(b => b[i])).flat();
  return [...in_turn(blocks), ...in_turn(checks)].filter(word => word !== undefined);
}

// Returns a value followed by the remainder of its division by a BCH generator of that degree.
function with_remainder(value, generator, degree) {
  let rest = value;
  for (let i = 0; i < degree; ++i) rest = rest << 1 ^ (rest >> degree - 1) * generator;
  return value << degree | rest;
}

// Draws what is the same in each symbol of a version; modules are by rows, 1 is dark; fixed ones are neither data nor masked.
function draw_fixed_parts(version) {
  const size = 17 + 4 * version;
  const symbol = {size, modules: new Uint8Array(size * size), fixed: new Uint8Array(size * size)};
  const squares = (row, column, reach, light) => {
    for (let y = -reach; y <= reach; ++y)
      for (let x = -reach; x <= reach; ++x)
        set_fixed(symbol, row + y, column + x, !light.includes(Math.max(Math.abs(x), Math.abs(y))));
  };
  for (let i = 0; i < size; ++i) {
    set_fixed(symbol, 6, i, i % 2 === 0);
    set_fixed(symbol, i, 6, i % 2 === 0);
  }
  for (const [row, column] of [[3, 3], [3, size - 4], [size - 4, 3]]) squares(row, column, 4, [2, 4]);
  const places = version < 2 ? [] : version < 7 ? [6, size - 7] : [6, (size - 1) / 2, size - 7];
  for (const row of places)
    for (const column of places)
      if (Math.min(row, column) > 6 || (row !== column && Math.max(row, column) < size - 7)) squares(row, column, 2, [1]);
  draw_format(symbol, 0);
  if (version >= 7) {
    const bits = with_remainder(version, 0x1f25, 12);
    for (let i = 0; i < 18; ++i) {
      const near = Math.floor(i / 3), far = size - 11 + i % 3;
      set_fixed(symbol, near, far, bits >> i & 1);
      set_fixed(symbol, far, near, bits >> i & 1);
    }
  }
  return symbol;
}

function set_fixed({size, modules, fixed}, row, column, dark) {
  if (Math.min(row, column) < 0 || Math.max(row, column) >= size) return;
  modules[row * size + column] = Number(dark);
  fixed[row * size + column] = 1;
}

// Writes the mask beside the finders, twice; level M is 0 in its upper bits.
function draw_format(symbol, mask) {
  const bits = with_remainder(mask, 0x537, 10) ^ 0x5412;
  for (let i = 0; i < 15; ++i) {
    const dark = bits >> i & 1;
    if (i < 8) set_fixed(symbol, i < 6 ? i : i + 1, 8, dark);
    else set_fixed(symbol, 8, i < 9 ? 7 : 14 - i, dark);
    if (i < 8) set_fixed(symbol, 8, symbol.size - 1 - i, dark);
    else set_fixed(symbol, symbol.size - 15 + i, 8, dark);
  }
  set_fixed(symbol, symbol.size - 8, 8, true);
}

// Fills pairs of columns from the right, upwards and downwards in turn; the column of the timing pattern is left out.
function draw_codewords({size, modules, fixed}, words) {
  let at = 0;
  for (let right = size - 1; right > 0; right -= right === 8 ? 3 : 2) {
    const pair = right > 6 ? (size - 1 - right) / 2 : (size - 2 - right) / 2;
    for (let i = 0; i < 2 * size; ++i) {
      const row = pair % 2 === 0 ? size - 1 - (i >> 1) : i >> 1, place = row * size + right - i % 2;
      if (fixed[place]) continue;
      modules[place] = words[at >> 3] >> 7 - at % 8 & 1; // beyond the last word: 0
      ++at;
    }
  }
}

function apply_mask(symbol, mask) {
  const {size, fixed} = symbol;
  draw_format(symbol, mask);
  return symbol.modules.map((dark, i) => dark ^ (!fixed[i] && QR_MASKS[mask](Math.floor(i / size), i % size) === 0));
}

// Judges modules by the four rules of the standard; the less, the easier to read.
function penalty(size, modules) {
  const rows = Array.from({length: size}, (_, y) => modules.subarray(y * size, (y + 1) * size).join(""));
  const columns = rows.map((_, x) => rows.map(r => r[x]).join(""));
  let sum = 0;
  for (const line of [...rows, ...columns]) {
    for (const run of line.match(/0{5,}|1{5,}/g) ?? []) sum += run.length - 2;
    sum += 40 * [...`0000${line}0000`.matchAll(/(?=00001011101|10111010000)/g)].length; // like a finder; the margin is light
  }
  for (let y = 1; y < size; ++y)
    for (let x = 1; x < size; ++x)
      if (rows[y][x] === rows[y][x - 1] && rows[y][x] === rows[y - 1][x] && rows[y][x] === rows[y - 1][x - 1]) sum += 3;
  const dark = modules.reduce((n, m) => n + m, 0);
  return sum + 10 * Math.floor(Math.abs(100 * dark / size ** 2 - 50) / 5);
}
