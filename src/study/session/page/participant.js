// SPDX-License-Identifier: MIT
import {by_id, make, show_only_if} from "../../../net/page/dom.js";
import {draw_target, move_target} from "./motion.js";
import {show_answers, enable_answers, mark_answer, show_stimuli} from "./answers.js";
import {make_key_guard} from "./key_guard.js";

const RETRY_MS = 500;
const LAST = ["over", "elsewhere"]; // last screens of a session or a page
const ALONE = ["target", "rest", "wait", "pause", "over", "elsewhere"]; // screens without answers
const BETWEEN = ["wait", "pause"];  // screens that keep the progress shown before

let socket = null, facts = {}, words = {}, state = {screen: "wait", ask: 0}, began = 0;

// The program has the session's state. This page shows the program's last message and stores nothing else.
function connect() {
  socket = new WebSocket(`ws://${location.host}/rpc`);
  socket.onopen = () => socket.send('{"hello":true}');
  socket.onmessage = m => {
    const message = JSON.parse(m.data);
    if (message.words) greet(message); else show(message);
  };
  socket.onclose = () => {
    if (LAST.includes(state.screen)) return;
    state.ask = 0;
    enable_answers(false);
    show_only_if(by_id("offline"), words.offline);
    setTimeout(connect, RETRY_MS);
  };
}
function greet(all) {
  [facts, words] = [all, all.words];
  document.documentElement.lang = words.language;
  by_id("offline").lastElementChild.textContent = words.offline;
  show_only_if(by_id("offline"), false);
  by_id("full").lastElementChild.textContent = words.full_screen;
  by_id("back").textContent = words.back;
  show_only_if(by_id("full"), document.fullscreenEnabled);
}

function show(s) {
  state = s;
  began = performance.now() - 1000 * (s.passed_s ?? 0);
  const looks = document.querySelector("main").classList;
  looks.value = s.screen;
  looks.toggle("alone", ALONE.includes(s.screen));
  looks.toggle("replies", Boolean(s.choices || s.entry || s.stimuli || s.screen === "walk")); // shows answers, or keeps room for them
  by_id("text").textContent = s.screen === "elsewhere" ? words.elsewhere : s.text ?? "";
  by_id("text").tabIndex = s.screen === "consent" ? 0 : -1; // so that keys can scroll a long text
  by_id("question").textContent = s.question ?? "";
  for (const mark of by_id("mark").children) show_only_if(mark, !s.stimuli && mark.dataset.on.split(" ").includes(s.screen));
  if (s.progress || !BETWEEN.includes(s.screen)) show_progress(s.progress, s.screen === "rest");
  show_stimuli(s.stimuli ?? 0, s.playing ?? 0, s.names);
  show_answers(s, facts, words, answer);
  enable_answers(state.ask > 0);
  show_only_if(by_id("back"), s.back);
  show_only_if(by_id("field"), s.paths);
  show_only_if(by_id("rest"), s.screen === "rest");
  if (s.paths) draw_target(facts.tactors, s.paths);
  if (s.lasts_s) move(s);
}

// Shows the progress of the session. The bar has a segment for each part; the present segment fills with its trials.
function show_progress(p, part_is_over) {
  const bar = by_id("bar"), parts = [];
  show_only_if(bar, p);
  if (p?.runs > 1 || p && !p.trial) parts.push(`${words.part} ${p.run} / ${p.runs}`);
  if (p?.practice) parts.push(words.practice);
  if (p?.trial) parts.push(`${p.trial} / ${p.at_most ? words.at_most + " " : ""}${p.trials}`);
  by_id("where").textContent = parts.join(" · ");
  if (!p) return;
  const done = part_is_over ? p.trials : Math.max(0, p.trial - 1);
  bar.setAttribute("aria-valuemax", p.trials);
  bar.setAttribute("aria-valuenow", done);
  bar.classList.toggle("practice", p.practice);
  while (bar.children.length > p.runs) bar.lastChild.remove();
  while (bar.children.length < p.runs) bar.append(make("i"));
  [...bar.children].forEach((segment, i) => segment.style.setProperty("--done", i + 1 < p.run ? 1 : i + 1 === p.run ? done / p.trials : 0));
}

// Moves the target, or shows the time left of a break, by the program's clock.
function move(s) {
  if (s !== state) return;
  const passed_s = (performance.now() - began) / 1000;
  if (s.paths) move_target(s.paths, passed_s / s.lasts_s);
  else show_left(Math.max(0, s.lasts_s - passed_s), s.lasts_s);
  requestAnimationFrame(() => move(s));
}
function show_left(left_s, lasts_s) {
  const left = Math.ceil(left_s);
  by_id("left").textContent = left < 60 ? left : `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}`;
  by_id("rest").style.setProperty("--left", left_s / lasts_s);
}

function answer(choice) {
  if (choice > state.choices?.length || !send({[typeof choice === "string" ? "text" : Array.isArray(choice) ? "drawing" : "answer"]: choice})) return;
  mark_answer(choice);
}
function send(reply) {
  if (!state.ask || socket.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify({ask: state.ask, ...reply}));
  state.ask = 0; // the next message shows whether the answer arrived
  enable_answers(false);
  return true;
}
const go_back = () => state.back && send({back: true});
const guard = make_key_guard();
// A double click answers once: its second click may hit the next screen. A question about stimuli cannot follow so soon.
addEventListener("click", e => { if (e.detail > 1 && state.screen !== "question") e.stopPropagation(); }, true);
addEventListener("keydown", e => {
  const presses = e.key === " " || e.key === "Enter", types = e.target.matches?.("textarea, input:not([type=range])");
  if (guard(e.key, performance.now()) && types && !e.target.value) return e.preventDefault(); // the key answered the previous question
  if (e.repeat && presses) e.preventDefault(); // a held key answers once
  if (e.repeat || e.ctrlKey || e.altKey || e.metaKey) return;
  if (/^[1-9]$/.test(e.key) && state.choices?.length < 10) answer(Number(e.key)); // with more choices, 1 may be the start of 10
  else if (presses && state.choices?.length === 1 && !["full", "back"].includes(e.target.id)) {
    e.preventDefault(); // else the button would also get a click
    answer(1);
  } else if (e.key === "b" && !types) go_back();
});

by_id("back").addEventListener("click", go_back);
by_id("full").addEventListener("click", () => {
  const done = document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen();
  done.catch(() => {});
  by_id("full").blur(); // else the space key would press it
});
// Follows the system's light or dark theme.
const dark = matchMedia("(prefers-color-scheme: dark)");
const set_theme = () => { document.documentElement.dataset.theme = dark.matches ? "dark" : "light"; };
dark.onchange = set_theme;
set_theme();
connect();

// For the console and for tests: variables in esbuild's bundle are not visible from outside.
Object.defineProperties(globalThis, {state: {get: () => state}, began: {get: () => began}, socket: {get: () => socket}});
