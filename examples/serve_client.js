#!/usr/bin/env node
// SPDX-License-Identifier: MIT
// Draws through `tactor serve` from Node.js, with nothing but its own modules: a preset, then a circle point by
// point.
//   node serve_client.js [SOCKET]     default: $XDG_RUNTIME_DIR/tactor.sock
'use strict';
const net = require('node:net');
const { createInterface } = require('node:readline');
const { setTimeout: pause } = require('node:timers/promises');

const socket = net.connect(process.argv[2] ?? `${process.env.XDG_RUNTIME_DIR}/tactor.sock`);
const answers = new Map(); // of calls, by their id
const ends = new Map(); // of strokes, by their number
let calls = 0;

const tell = (method, params, id) => socket.write(JSON.stringify({ jsonrpc: '2.0', method, params, id }) + '\n');
const call = (method, params) => new Promise((resolve, reject) => {
  answers.set(++calls, { resolve, reject });
  tell(method, params, calls);
});
// May be asked for before or after the end has come.
const end = (stroke) => {
  if (!ends.has(stroke)) {
    let resolve;
    const told = new Promise((r) => { resolve = r; });
    ends.set(stroke, { told, resolve });
  }
  return ends.get(stroke);
};

const fail = (e) => { console.error(`serve_client: ${e.message}`); process.exit(1); };
const lines = createInterface({ input: socket });
lines.on('line', (line) => {
  const { id, result, error, method, params } = JSON.parse(line);
  if (method === 'stroke' && params.state !== 'started') end(params.stroke).resolve(params.state);
  if (id === undefined || !answers.has(id)) return;
  if (error) answers.get(id).reject(new Error(error.message));
  else answers.get(id).resolve(result);
  answers.delete(id);
});
for (const source of [socket, lines]) source.on('error', fail);

async function main() {
  const { stroke } = await call('play', { stroke: 'park2016-1' });
  console.log(`park2016-1: ${await end(stroke).told}`);

  const live = (await call('begin', { timeout_s: 60, options: { phantom: 'barycentric' } })).stroke;
  for (let i = 0; i < 50; ++i, await pause(10)) {
    const angle = 2 * Math.PI * i / 50;
    tell('to', { stroke: live, x_mm: 20 + 10 * Math.cos(angle), y_mm: 20 + 10 * Math.sin(angle) });
  }
  tell('end', { stroke: live });
  console.log(`circle: ${await end(live).told}`);
  socket.end();
}
main().catch(fail);
