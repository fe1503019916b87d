// SPDX-License-Identifier: MIT
// The WebSocket to the service: calls, answers and notifications.
import {state, changed, now_ms} from "../state.js";
import {fault_sentence} from "../words.js";

export const SLOW_MS = 300; // time without an answer that counts as slow
const POLL_MS = 500;
const LONGEST_RETRY_MS = 5000;
const CODE_TOKEN = -32003;

let socket = null, last = 0, retry_ms = 500, retry_timer = 0, token = null, name = "";
const calls = new Map();
const hearers = {}, losers = [];
let offset_s = 0, best_trip_s = Infinity; // offset of the server's monotonic clock from now_ms(), and its best round trip

export const is_connected = () => state.link === "connected";
// Sets the handler for notifications of a method.
export function on_notification(method, f) { hearers[method] = f; }
// Adds a handler for the loss of the connection.
export function on_lost(f) { losers.push(f); }
let greet = () => {};
export function on_hello(f) { greet = f; }
export const server_now_s = () => now_ms() / 1000 + offset_s;
export const from_server_ms = s => (s - offset_s) * 1000;

class Fault extends Error {
  constructor(e) {
    super(e.message);
    this.code = e.code; // 0: there is no connection
    this.sent = e.sent ?? true;
    this.data = e.data ?? {};
  }
}

export function call(method, params = {}) {
  return new Promise((done, failed) => {
    if (socket?.readyState !== WebSocket.OPEN) return failed(new Fault({code: 0, sent: false, message: "there is no connection to tactor"}));
    const id = ++last;
    calls.set(id, {done, failed, at: now_ms(), method});
    socket.send(JSON.stringify({jsonrpc: "2.0", id, method, params}));
  });
}
export function tell(method, params) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({jsonrpc: "2.0", method, params}));
}

// Removes the token from the address, which others see. The tab keeps it for a reload.
function take_token(t) {
  token = t;
  if (location.hash) history.replaceState(null, "", location.pathname);
  try { if (token) sessionStorage.setItem("tactor-token", token); } catch { /* for this visit only */ }
}
const remembered_token = () => { try { return sessionStorage.getItem("tactor-token"); } catch { return null; } };
// Returns the address with the token, with which anybody can draw.
export const page_link = () => location.origin + location.pathname + (token ? `#token=${encodeURIComponent(token)}` : "");

export function connect(own_name = name) {
  name = own_name;
  clearTimeout(retry_timer);
  take_token(new URLSearchParams(location.hash.slice(1)).get("token") ?? token ?? remembered_token());
  const own = socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/rpc`);
  own.onopen = () => hello();
  own.onmessage = m => own === socket && hear(JSON.parse(m.data));
  own.onclose = e => own === socket && lost(e.reason);
}
export function connect_with(new_token) {
  take_token(new_token || null);
  state.asks_token = "";
  const old = socket;
  socket = null;
  old?.close();
  fail_calls();
  connect();
}

const introduce = () => call("hello", {...token && {token}, ...name && {name}});
// Renames the client, now and after each reconnection.
export function rename_client(new_name) {
  name = new_name;
  return is_connected() ? introduce() : Promise.resolve();
}
async function hello() {
  try {
    const asked = server_now_s(), h = await introduce();
    set_clock(h.clock.monotonic_s, asked);
    state.hello = h;
    tell("level", {db: state.level_db}); // sent before anything plays, because a connection begins at the ceiling
    state.asks_token = "";
    await call("subscribe", {events: ["levels", "stream", "strokes", "touches", "stops"], levels_hz: 30});
    await poll();
    state.link = "connected";
    retry_ms = 500;
    await greet(h);
    changed("link", "array", "stream");
  } catch (e) {
    if (e.code === CODE_TOKEN) {
      state.asks_token = token ? "The token is wrong." : "This service needs a token.";
      state.link = "token";
      changed("link");
    } else if (e.code !== 0) {
      state.fault = fault_sentence(e);
      socket?.close();
    }
  }
}
function set_clock(server_s, asked_s) {
  const trip = server_now_s() - asked_s;
  if (trip > best_trip_s + 0.005) return;
  best_trip_s = trip;
  offset_s += server_s + trip / 2 - server_now_s();
}

function lost(reason) {
  socket = null;
  fail_calls();
  state.dbfs = [];
  state.touches.clear();
  state.slow = false;
  if (state.link !== "token" || !state.asks_token) {
    state.link = "lost";
    state.lost_reason = reason;
    state.retry_at = now_ms() + retry_ms;
    retry_timer = setTimeout(() => connect(), retry_ms);
    retry_ms = Math.min(LONGEST_RETRY_MS, retry_ms * 2);
  }
  losers.forEach(f => f());
  changed("link");
}
function fail_calls() {
  const waiting = [...calls.values()];
  calls.clear();
  waiting.forEach(c => c.failed(new Fault({code: 0, message: "the connection is gone"})));
}

function hear(m) {
  if (m.method) return hearers[m.method]?.(m.params);
  const c = calls.get(m.id);
  calls.delete(m.id);
  if (!c) return;
  if (m.error) c.failed(new Fault(m.error)); else c.done(m.result);
}

async function poll() {
  const s = await call("status");
  state.status = s;
  state.stream = {state: s.stream.state, reason: s.stream.reason};
  if (s.stream.state !== "lost") state.hello.stream.format ??= ""; // a card was connected
  changed("status");
}
setInterval(() => {
  if (is_connected() && ![...calls.values()].some(c => c.method === "status")) poll().catch(() => {});
}, POLL_MS);
// Shows that answers are missing, while they are.
setInterval(() => {
  const now = now_ms();
  const slow = [...calls.values()].some(c => (c.method === "status" || c.method === "stop") && now - c.at > SLOW_MS);
  if (slow !== state.slow) { state.slow = slow; changed("link"); }
  if (state.link === "lost") changed("link");
}, 100);
