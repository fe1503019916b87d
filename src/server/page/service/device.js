// SPDX-License-Identifier: MIT
// State of the service: a word and a reason for each state, and a banner if the user must act.
import {state, on_change, changed, ceiling_dbfs, is_cardless, is_simulated, say, remember, remembered, now_ms} from "../state.js";
import {by_id, make, on_click, listen, set_text} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {connect_with, connect, rename_client} from "./connection.js";
import {test_tactor, unanswered_s, stop_words} from "./player.js";
import {on_hold} from "./hold.js";
import {drive_tactor} from "../drawing/pointer.js";
import {array_name, number_text, fault_sentence} from "../words.js";

const STOPPED_MS = 6000;

// Returns [icon, word, tone, reason].
function describe() {
  const s = state.stream;
  if (state.link === "connecting") return ["waiting", "Connecting", "off", ""];
  if (state.link === "token") return ["barred", "Locked", "warn", "it needs a token"];
  if (state.link === "lost") return ["broken", "No connection", "bad",
    `tries again in ${Math.max(0, Math.ceil((state.retry_at - now_ms()) / 1000))} s`];
  if (state.slow) return ["waiting", "No answer", "warn", "waiting for tactor"];
  if (is_cardless()) return ["barred", "Simulated", "off", "no card"];
  if (s.state === "lost") return ["broken", "Card lost", "bad", "tactor looks for it"];
  if (s.state === "muted") return ["muted", "Muted", "warn", s.reason];
  if (s.state === "closing") return ["stop", "Closing", "warn", "tactor shuts down"];
  if (state.stopped && now_ms() - state.stopped.at < STOPPED_MS) return ["stop", "Stopped", "off",
    `by ${state.stopped.name}`];
  const other = state.status?.strokes.find(k => k.state === "started" && k.client !== state.hello?.client);
  if (other) return ["people", "Someone is playing", "info", who(other.client)];
  if (is_simulated()) return ["barred", "Simulated", "off", "no card"];
  const why = state.hello?.stream.pcm ?? "";
  return s.state === "idle" ? ["ready", "Ready", "ok", why] : ["running", "Running", "ok", why];
}
const who = client => { const w = state.status?.who?.find(x => x.client === client); return w ? w.name ? `“${w.name}”` : w.from : ""; };

// Returns the contents of the banner, [text, tone, details], or null.
function warn() {
  const s = state.stream;
  if (unanswered_s()) return [`Stop is ${stop_words()[1]}. Switch the amplifier off.`, "bad", ""];
  if (state.link === "token") return [state.asks_token, "warn",
    "Ask the owner, whose token_file has it, or open the link that ends in #token=…"];
  if (state.link === "lost") return ["No connection to tactor. The page tries again; nothing is lost.", "bad", state.lost_reason
    || "The WebSocket to the service is closed."];
  if (state.unkept.size) return [`Takes are not kept: ${state.storage_fault}.`, "warn",
    "The page tries again with each change. Save what you need as a file; the page asks before it closes."];
  if (state.link === "connected" && state.slow) return null;
  if (s.state === "lost" && !is_cardless()) return ["The sound card is gone. Plug it in again; the page keeps your drawings.", "bad", s.reason];
  if (s.state === "muted") return ["Muted, because the sound broke up. It returns when it is steady.", "warn", s.reason];
  if (s.state === "closing") return ["tactor shuts down. The page keeps your drawings.", "warn", s.reason];
  if (state.fault) return [state.fault, "bad", ""];
  return null;
}

let closed = "", shown_icon = "";
function show_device() {
  const [picture, word, tone, why] = describe();
  if (picture !== shown_icon) by_id("device-icon").replaceChildren(icon(shown_icon = picture));
  set_text("state", word);
  set_text("state-why", why ? ` · ${why}` : "");
  by_id("device").dataset.tone = tone;
  set_text("array-name", state.hello ? array_name(state.hello.array) : "tactor");
  const others = Math.max(0, (state.status?.who?.length ?? state.status?.clients ?? 1) - 1);
  by_id("others").hidden = others === 0;
  by_id("others-text").replaceChildren(String(others), make("i", {}, others === 1 ? " other" : " others"));
  by_id("others").setAttribute("aria-label", `${others} ${others === 1 ? "other" : "others"}`);
  const [text, banner_tone, details] = warn() ?? ["", "", ""];
  if (!text) closed = "";
  by_id("banner-close").hidden = state.unkept.size > 0;
  by_id("save-all").hidden = !state.unkept.size;
  by_id("banner").hidden = text === closed;
  if (text === closed) return;
  by_id("banner").dataset.tone = banner_tone;
  set_text("banner-text", text);
  set_text("banner-details", details);
  by_id("banner-more").hidden = !details;
  by_id("token").hidden = state.link !== "token";
}
on_click("banner-close", () => {
  closed = by_id("banner-text").textContent;
  state.fault = null;
  changed("link");
});
on_click("banner-more", () => {
  const d = by_id("banner-details");
  d.hidden = !d.hidden;
  by_id("banner-more").setAttribute("aria-expanded", !d.hidden);
});
listen("token", "submit", e => {
  e.preventDefault();
  connect_with(by_id("token-text").value.trim());
  by_id("token-text").value = "";
});
addEventListener("hashchange", () => { if (state.link !== "connected") connect(); });

// Shows a list of facts, without unknown ones.
function list_facts(id, facts) {
  by_id(id).replaceChildren(...Object.entries(facts).flatMap(([name, v]) => (v ?? "") === "" ? [] : [make("dt", {}, name), make("dd", {}, String(v))]));
}
listen("p-device", "beforetoggle", () => {
  const {hello, status, stream} = state;
  if (!hello) return list_facts("facts", {State: "no connection"});
  const {array, stream: {pcm, rate, channels, format, period_frames, latency_s}} = hello;
  list_facts("facts", {
    Array: `${array_name(array)}, ${array.tactors.length} tactors`, Where: array.site, Card: pcm,
    Stream: `${rate} Hz, ${channels} channels${format ? `, ${format}` : ""}`,
    Period: `${period_frames} frames (${number_text(1000 * period_frames / rate)} ms), buffer ${number_text(1000 * latency_s)} ms`,
    State: `${stream.state}${stream.reason ? `: ${stream.reason}` : ""}`, Amplifier: status?.amplifier, Xruns: status?.stream.xruns,
    "Real time": status && (status.stream.realtime ? "yes" : "no"), Ceiling: `${number_text(ceiling_dbfs(), 0)} dBFS`, Version: hello.version,
  });
});
on_change(() => {
  if (!state.hello) return;
  by_id("tactor-facts").replaceChildren();
  by_id("try").replaceChildren(...state.hello.array.tactors.map((_, i) => {
    const b = make("button", {class: "button outlined", "aria-label": `Try tactor ${i}`, onclick: () => test_tactor(i),
      onfocus: () => show_tactor(i), onpointerdown: () => show_tactor(i)}, i);
    on_hold(b, () => drive_tactor(i));
    return b;
  }));
}, "array");
listen("p-others", "beforetoggle", () => {
  by_id("people").replaceChildren(...(state.status?.who ?? []).map(w => make("li", {},
    make("b", {}, w.client === state.hello?.client ? `${w.name || "You"} (this page)` : w.name ? `“${w.name}”` : "no name"),
    make("small", {}, `${w.from}${state.status.strokes.some(k => k.client === w.client && k.state === "started") ? ", playing" : ", silent"}`))));
});
listen("own-name", "submit", e => e.preventDefault());
listen("own-name-text", "change", () => {
  remember("name", by_id("own-name-text").value.trim());
  rename_client(own_name()).catch(e => say(fault_sentence(e)));
});
by_id("own-name-text").value = remembered("name") ?? "";
export const own_name = () => remembered("name") || (matchMedia("(pointer: coarse)").matches ? "A phone" : "A browser");
// Shows what is known of a tactor.
function show_tactor(i) {
  const t = state.hello.array.tactors[i];
  list_facts("tactor-facts", {
    Tactor: i, Place: `${t.x_mm}, ${t.y_mm} mm`, Channel: t.channel, Gain: t.gain_db === undefined ? null : `${number_text(t.gain_db)} dB`,
    Limit: `${number_text(t.max_dbfs ?? 0)} dBFS`, Threshold: typeof t.threshold_dbfs === "number" ? `${number_text(t.threshold_dbfs)} dBFS` : "not measured",
    Polarity: t.polarity < 0 ? "reversed" : "as wired",
  });
}
// Clears the fault, which was about the take before the change.
on_change(() => { state.fault = null; }, "take");
on_change(show_device, "take", "link", "status", "stream", "array", "playing");
setInterval(() => { if (state.stopped) show_device(); }, 1000);
