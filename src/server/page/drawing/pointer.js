// SPDX-License-Identifier: MIT
// Fingers, pen, mouse and keys on the array: drawing, straight lines, points, tests of single tactors.
import {state, changed, current_take, current_stroke, ceiling_dbfs, is_cardless, is_simulated, say, now_ms} from "../state.js";
import {by_id, listen} from "../../../net/page/dom.js";
import {call, tell, is_connected, on_lost} from "../service/connection.js";
import {array, to_mm, to_px, view, tactor_at, zoom, zoom_by_two, pan, ARROWS} from "./view.js";
import {add_take, edit_take, edit_stroke, end_edit, request_options} from "../takes/takes.js";
import {say_if_kept} from "../takes/keeping.js";
import {from_drawing, straight, editable, nearest_knot, insert_knot, changed_knot, without_knot, total_s} from "../takes/stroke.js";
import {distance, outside_mm} from "../geometry.js";
import {felt_points, grasp_felt, pull, step_felt} from "./felt.js";
import {test_tactor, tap_tactor, tell_level, on_stop} from "../service/player.js";
import {press, let_go} from "../service/hold.js";
import {fault_sentence} from "../words.js";

const RESTING_MS = 100;    // interval at which a resting finger sends its place, or its stroke would end
const LEAST_MM = 1;        // a shorter touch is a tap
const LEAST_STEP_MS = 2;   // least interval of sent points
const REACH_PX = 22, LEAST_PX = 3; // reach of a point, and the distance from which on it is dragged
const LINE_PX = 16, PINCH_PX = 200; // height of a wheel's line, and the wheel's distance that zooms by e
const LINE_MM_S = 60;
const MOVE_MM = 0.5, FINE_MOVE_MM = 0.1; // steps of a point that keys move
export const PAUSE_S = 0.1; // pause between strokes of a take that were drawn, or copied, one after the other
const NAMES = {mouse: "drawn", touch: "drawn", pen: "drawn with a pen", key: "drawn with keys"};

const field = by_id("field");
const fingers = new Map();

const to_pixel = e => { const r = field.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
// Returns the strength of a touch: a pen's pressure, or its previous one when it lifts. Mice and most fingers have no pressure.
const strength = (e, before = 1) => e.pointerType !== "pen" ? 1 : e.pressure > 0 ? Math.min(1, +e.pressure.toFixed(3)) : before;
const seconds = ms => +(ms / 1000).toFixed(4);

function down(id, px, e) {
  if (!array || state.placing || fingers.has(id)) return;
  if (e.pointerType === "touch" && [...fingers.values()].some(f => f.kind === "pen")) return; // this touch is the hand that holds the pen
  if (e.pointerType === "pen") drop_palm();
  const mm = to_mm(...px);
  const f = {id, px, from: mm, at: mm, strength: strength(e), kind: e.pointerType, down_ms: e.timeStamp, mode: "tap",
    straight: state.tool === "line" || e.shiftKey, sent_ms: 0, number: null};
  if (state.tool === "felt") { f.mode = "felt"; f.off = grasp_felt(mm); if (!f.off) return; }
  if (f.mode === "felt" || state.tool === "points" && grasp(f, mm)) { fingers.set(id, f); return; }
  const tactor = tactor_at(mm);
  if (tactor >= 0) press(id, field, () => { f.mode = "held"; return drive_tactor(tactor); });
  f.tactor = tactor;
  fingers.set(id, f);
  // Two fingers that begin together on the ground only zoom.
  f.ground = f.kind === "touch" && outside_mm(array.edge, mm) > array.radius;
  const other = f.ground && [...fingers.values()].find(o => o !== f && o.ground && o.mode === "tap");
  if (other) [f, other].forEach(o => { o.mode = "zoom"; });
}

function moved(id, px, e) {
  const f = fingers.get(id);
  if (!f) return;
  const mm = to_mm(...px);
  if (f.mode === "zoom") {
    const other = [...fingers.values()].find(o => o !== f && o.mode === "zoom");
    if (other) zoom_by_two([f.px, other.px], [px, other.px]);
    f.px = px;
    return;
  }
  f.at = mm;
  f.strength = strength(e, f.strength);
  if (f.off) {
    if (!f.moved && distance(px, f.px) < LEAST_PX) return;
    f.moved = true;
    const place = [mm[0] + f.off[0], mm[1] + f.off[1]];
    return f.mode === "felt" ? pull(place) : move_knot(f.knot, place, f.key);
  }
  if (f.mode === "tap" && distance(mm, f.from) > LEAST_MM && state.tool !== "points") begin(f);
  if (f.mode === "draw") record(f, mm, e.timeStamp);
}

function begin(f) {
  let_go(f.id);
  f.mode = "draw";
  const now = f.down_ms;
  if (!state.drawing) {
    const append = state.append && current_take() !== null, before = append ? current_take().strokes : [];
    state.drawing = {began: now - 1000 * total_s(before), before, tracks: [], kind: f.kind, append};
    state.stopped = null;
    document.body.classList.add("touching");
  }
  f.track = {start_s: Math.max(0, seconds(now - state.drawing.began)), began: now, points: [[0, ...rounded(f.from), f.strength]], down: true,
    straight: f.straight};
  state.drawing.tracks.push(f.track);
  if (state.feel && is_connected() && !is_cardless()) begin_live(f);
  changed("drawing", "link");
}
const rounded = p => p.map(v => +v.toFixed(3));

function record(f, mm, at_ms) {
  const t = seconds(at_ms - f.track.began);
  if (f.straight) f.track.points.length = 1;
  if (t <= f.track.points.at(-1)[0]) return;
  f.track.points.push([t, ...rounded(mm), f.strength]);
  send(f, at_ms);
  changed("ink");
}

// Begins a live stroke, so that the drawing is felt.
export function begin_live(f, own_options = current_take()?.options) {
  tell_level();
  const o = request_options({options: own_options}, ceiling_dbfs());
  if (o.algorithm === "tactile-brush") o.algorithm = "continuous"; // Tactile Brush must know the end first
  const live = new Set(state.options.filter(r => r.live).map(r => r.name));
  const options = Object.fromEntries(Object.entries(o).filter(([name]) => live.has(name) || !live.size));
  call("begin", {options}).then(r => {
    f.number = r.stroke;
    if (f.dropped) return tell("cancel", {stroke: f.number});
    if (state.compare) tell("level", {db: state.level_db, stroke: f.number}); // which is silent but for a side
    send(f, now_ms(), true);
    if (!f.track.down) tell("end", {stroke: f.number});
  }, e => { if (!f.refused) say(fault_sentence(e)); f.refused = true; });
}
export function send(f, at_ms, always = false) {
  if (f.number === null || (!always && at_ms - f.sent_ms < LEAST_STEP_MS)) return;
  f.sent_ms = at_ms;
  tell("to", {stroke: f.number, x_mm: f.at[0], y_mm: f.at[1], intensity: f.strength});
}
setInterval(() => fingers.forEach(f => f.mode === "draw" && send(f, now_ms(), true)), RESTING_MS);

// Drives a tactor until the function that it returns is called, or somebody stops. It is a stroke that rests. Ends when the page
// disconnects. At a tactor's place only that tactor plays.
export function drive_tactor(i) {
  if (!is_connected()) return void say("No connection: nothing plays");
  const began_ms = now_ms(), f = {at: array.places[i], strength: 1, number: null, sent_ms: 0, track: {down: true}};
  if (is_simulated()) tap_tactor(i, Infinity);
  if (!is_cardless()) begin_live(f, {algorithm: "continuous", phantom: "barycentric"});
  const end = () => {
    clearInterval(timer);
    if (state.tapped === i) tap_tactor(-1);
    f.track.down = false; // one that has no number yet ends when it has
    if (f.number !== null) tell("end", {stroke: f.number});
    f.number = null;
  };
  const timer = setInterval(() => { if (state.stopped?.at > began_ms) end(); else send(f, now_ms(), true); }, RESTING_MS);
  return end;
}

function up(id, cancelled = false) {
  const f = fingers.get(id);
  if (!f) return;
  fingers.delete(id);
  let_go(id);
  if (f.mode === "knot") { end_edit(); changed("take"); return; }
  if (f.mode === "tap" && !cancelled) return tap(f);
  if (f.mode !== "draw") return;
  f.track.down = false;
  const t = seconds(now_ms() - f.track.began), last = f.track.points.at(-1);
  // If the finger rests before it lifts, the stroke rests as long.
  if (t > last[0] + 0.05) f.track.points.push([t, last[1], last[2], last[3]]);
  if (f.number !== null) tell("end", {stroke: f.number});
  if ([...fingers.values()].some(o => o.mode === "draw")) return changed("drawing");
  finish();
}
// Takes back a touch that the system cancels while others go on: it was a palm. A drawing of one finger is kept.
function take_back(id) {
  const f = fingers.get(id), others = [...fingers.values()].some(o => o !== f && o.mode === "draw");
  if (f?.mode !== "draw" || !(others || f.kind === "touch" && state.drawing.kind === "pen")) return up(id, true);
  drop(f);
  if (!others) return finish();
  changed("drawing");
}
function drop(f) {
  fingers.delete(f.id);
  state.drawing.tracks = state.drawing.tracks.filter(k => k !== f.track);
  f.track.down = false;
  f.dropped = true;
  if (f.number !== null) tell("cancel", {stroke: f.number});
}
// Drops touches before a pen's: the hand may lie on the array before its pen does.
function drop_palm() {
  for (const f of [...fingers.values()]) if (f.kind === "touch" && f.mode === "draw") drop(f); else if (f.kind === "touch") up(f.id, true);
  if (!state.drawing || [...fingers.values()].some(f => f.mode === "draw")) return;
  state.drawing = null;
  document.body.classList.remove("touching");
  changed("drawing");
}
function tap(f) {
  if (state.tool === "points" && choose_stroke(f.from)) return;
  if (f.tactor >= 0) test_tactor(f.tactor);
}

// Makes a take, or more strokes of this one, from all fingers that touched until the last one lifted.
function finish(take_name) {
  const d = state.drawing;
  state.drawing = null;
  document.body.classList.remove("touching");
  const tracks = d.tracks.filter(k => k.points.length > 1);
  if (!tracks.length) return changed("drawing");
  const strokes = tracks.map((k, i) => {
    const name = tracks.length > 1 ? `finger ${i + 1}` : `stroke ${d.before.length + 1}`;
    const start = k.points[0].slice(1, 3), [, x, y, strong] = k.points.at(-1);
    return k.straight ? straight(start, [x, y], LINE_MM_S, name, k.start_s, strong) : from_drawing(k.points, name, k.start_s);
  });
  // Further strokes follow the last one, whenever they were drawn. They start after its last burst has ended.
  const first = Math.min(...strokes.map(s => s.start_s)), from_s = d.append ? total_s(d.before) + PAUSE_S : 0;
  const placed = strokes.map(s => ({...s, start_s: +(s.start_s - first + from_s).toFixed(4)}));
  if (d.append) {
    edit_take(t => ({strokes: [...t.strokes, ...placed]}));
    Object.assign(state, {stroke: d.before.length, append: false});
  } else say_if_kept(add_take(placed, {name: take_name, origin: NAMES[d.kind]}));
  state.at_s = 0;
  changed("drawing", "take");
}
// Makes a take of a drawing while the page goes away.
export function finish_early() {
  if (!state.drawing) return;
  fingers.clear();
  finish(`Drawing of ${new Date().toTimeString().slice(0, 5)}, unfinished`);
}
function lift_all() {
  key = null;
  for (const id of [...fingers.keys()]) up(id, true);
}
on_stop(lift_all);
// Drawing continues silently without a connection, which has ended its live strokes.
on_lost(() => fingers.forEach(f => { f.number = null; }));

// Editing of points.
const edited_stroke = () => current_stroke() && editable(current_stroke());
function grasp(f, mm) {
  const knots = edited_stroke()?.knots ?? [], near = nearest_knot(knots, mm), k = knots[near.index];
  if (near.off * view.scale > REACH_PX) return false;
  Object.assign(f, {mode: "knot", knot: near.index, off: [k.x - mm[0], k.y - mm[1]], key: `knot ${f.id} ${now_ms()}`});
  state.knot = near.index;
  changed("knot");
  return true;
}
const move_knot = (at, place, same) => edit_stroke(s => { const [x, y] = rounded(place); return changed_knot(s, at, {x, y}); }, same);
function add_point(mm) {
  const added = insert_knot(edited_stroke(), mm);
  edit_stroke(() => added.stroke);
  state.knot = added.index;
  changed("knot");
}
export const change_point = change => edit_stroke(s => changed_knot(s, state.knot, change));
export function remove_point() {
  const s = edited_stroke();
  if (!s || state.knot < 0 || s.knots.length <= 2) return;
  edit_stroke(t => without_knot(t, state.knot));
  state.knot = Math.min(state.knot, s.knots.length - 2);
  changed("knot");
}
// Chooses the stroke whose path is nearest; returns true if there is one.
function choose_stroke(mm) {
  const take = current_take();
  let best = {off: REACH_PX / view.scale, i: -1};
  take?.strokes.forEach((s, i) => s.timed.forEach(p => {
    const off = distance(p.slice(1), mm);
    if (off < best.off) best = {off, i};
  }));
  if (best.i < 0) return false;
  if (best.i === state.stroke && tactor_at(mm) < 0) add_point(mm);
  Object.assign(state, {stroke: best.i, knot: best.i === state.stroke ? state.knot : -1});
  changed("take");
  return true;
}

// Listeners. `pointerrawupdate` comes before the frame, in browsers that have it.
let middle = null;
listen(field, "pointerdown", e => {
  if (e.button === 1) { middle = [e.clientX, e.clientY]; field.setPointerCapture(e.pointerId); e.preventDefault(); return; }
  if (e.button > 0) return;
  try { field.setPointerCapture(e.pointerId); } catch { /* a pointer that is gone already */ }
  down(e.pointerId, to_pixel(e), e);
});
const raw = "onpointerrawupdate" in window;
function follow(e) {
  if (middle) { pan(e.clientX - middle[0], e.clientY - middle[1]); middle = [e.clientX, e.clientY]; return; }
  const f = fingers.get(e.pointerId);
  if (!f) return hover(e);
  const all = e.getCoalescedEvents?.() ?? [];
  for (const p of all.length ? all : [e]) moved(e.pointerId, to_pixel(p), p);
}
listen(field, raw ? "pointerrawupdate" : "pointermove", follow);
if (raw) listen(field, "pointermove", e => { if (fingers.has(e.pointerId)) moved(e.pointerId, to_pixel(e), e); });
listen(field, "pointerup", e => { middle = null; if (fingers.has(e.pointerId)) { moved(e.pointerId, to_pixel(e), e);
  up(e.pointerId); } });
listen(field, "pointercancel", e => { middle = null; take_back(e.pointerId); });
listen(field, "lostpointercapture", e => { middle = null; up(e.pointerId, true); });
listen(field, "pointerleave", () => set_hot(-1));
listen(field, "contextmenu", e => e.preventDefault());
listen(field, "wheel", e => {
  e.preventDefault();
  if (state.drawing) return;
  const r = field.getBoundingClientRect();
  // Two fingers on a touchpad arrive as a wheel, with ctrl if they pinch.
  const by = e.deltaMode ? LINE_PX : 1;
  if (e.ctrlKey) zoom(Math.exp(-e.deltaY * by / PINCH_PX), [e.clientX - r.left, e.clientY - r.top]);
  else if (e.shiftKey && !e.deltaX) pan(-e.deltaY * by, 0);
  else pan(-e.deltaX * by, -e.deltaY * by);
}, {passive: false});
function hover(e) { if (e.pointerType === "mouse" && array) set_hot(tactor_at(to_mm(...to_pixel(e)))); }
function set_hot(i) {
  if (state.hot === i) return;
  state.hot = i;
  changed("hot");
}

// Handles keys within the canvas. With the tools Points and Felt, Tab walks through the points, arrows move the chosen one, and Enter makes it a
// curve or a corner. Tab after the last one leaves the canvas.
function act_on_point(e) {
  const felt = state.tool === "felt";
  if ((state.tool !== "points" && !felt) || !current_stroke()) return false;
  const {knots} = edited_stroke(), at = state.knot, k = knots[at], step = ARROWS[e.key];
  if (e.key === "Tab") {
    const all = felt ? felt_points().map(q => q.knot) : [...knots.keys()], place = all.indexOf(at);
    state.knot = all[place < 0 && e.shiftKey ? all.length - 1 : place + (e.shiftKey ? -1 : 1)] ?? -1;
    changed("knot");
    return state.knot >= 0;
  }
  if (!k || (!step && (felt || e.key !== "Enter"))) return false;
  const mm = e.shiftKey ? FINE_MOVE_MM : MOVE_MM;
  if (!step) change_point({corner: !k.corner});
  else if (felt) step_felt(at, step.map(v => v * mm));
  else move_knot(at, [k.x + step[0] * mm, k.y + step[1] * mm], `key knot ${at}`);
  return true;
}
// Touch by keys: Enter touches and lifts, and arrows move.
let key = null;
listen(field, "keydown", e => {
  if (!array || state.placing || e.ctrlKey || e.metaKey || e.altKey) return;
  if (act_on_point(e)) return e.preventDefault();
  if (e.key === "Enter") {
    e.preventDefault();
    if (e.repeat) return;
    if (key) { key = null; up("key"); return; }
    key = array.box.middle.slice();
    down("key", to_px(key), {pointerType: "key", timeStamp: now_ms()});
    return;
  }
  const step = ARROWS[e.key], mm = Math.max(...array.box.size, 10) / (e.shiftKey ? 100 : 25);
  if (!step) return;
  e.preventDefault();
  if (!key) return;
  key = [key[0] + step[0] * mm, key[1] + step[1] * mm];
  moved("key", to_px(key), {pointerType: "key", timeStamp: now_ms()});
});
const lift_key = () => { if (key) { key = null; up("key"); } };
// A tap of Enter leaves the touch down; a tactor that it held is let go.
listen(field, "keyup", e => { if (e.key === "Enter" && let_go("key")) lift_key(); });
listen(field, "blur", lift_key);
