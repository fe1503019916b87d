// SPDX-License-Identifier: MIT
// Files that are opened and saved; the service reads and writes them as the tool does.
import {state, changed, on_change, current_take, say} from "../state.js";
import {by_id, make, on_click, all_of, listen, set_text} from "../../../net/page/dom.js";
import {call, is_connected, page_link} from "../service/connection.js";
import {add_take, make_request} from "./takes.js";
import {stroke_csv, with_level, rest_comment, take_toml, read_take} from "./stroke_file.js";
import {is_own_host} from "./address.js";
import {fault_text, fault_sentence} from "../words.js";

const MOST_BYTES = 700 << 10; // a message is at most 1 MiB
// Formats of strokes that the page writes without a connection, too, and their words.
const OWN_FORMATS = [{name: "toml", written: true}, {name: "csv", written: true, only_points: true}];
const FORMAT_WORDS = {toml: ["Stroke", "for the tool, a study and this page"], csv: ["Timed points", "a table: time, place, intensity"],
  haptic: ["Vibration, HAPTIC", "for controllers and phones: no places"]};
const OTHER_KINDS = [["svg", "Figure, SVG", "for a paper; can be edited"], ["png", "Figure, PNG", ""], ["pdf", "Figure, PDF", ""],
  ["wav", "Samples", "exactly what each channel plays"], ["json", "Plan", "all bursts as numbers"]];
const formats = () => state.hello?.formats ?? OWN_FORMATS;
const has_only_points = kind => formats().some(f => f.name === kind && f.only_points);

// Comment at the end of a figure of this page, with its stroke as TOML in base64, in one part or two.
const STROKE_OF_FIGURE = /<!-- stroke of this figure: ([\w+/= ]+) -->\s*$/;
const FIGURE = "it is a figure; open the stroke that it shows (.toml)";

async function open_files(files) {
  const faults = [];
  let message = "";
  for (const file of files) {
    try {
      const source = await what_to_import(file), r = await import_file(file, source), take = read_take(r, source.text, state.options);
      add_take(take.strokes, {...take, name: file.name.replace(/\.[^.]*$/, "").slice(0, 60), origin: "file"});
      message = r.warnings.join(" · ") || `Opened “${file.name}”`;
    } catch (e) { faults.push(`“${file.name}” was not opened: ${fault_text(e)}.`); }
  }
  if (message) say(message);
  if (!faults.length) return;
  // Shows the faults after the takes have changed, because a change clears older faults.
  requestAnimationFrame(() => { state.fault = faults.join(" "); changed("link"); });
}
// Asks for the value of intensity 1 if a recording goes above 1, as --intensity-max.
async function import_file(file, source) {
  try { return await call("import", source); } catch (e) {
    if (!e.data?.hint?.includes("intensity_max")) throw e;
    const most = Number(prompt(`“${file.name}”: ${e.data.why}. ` + "Which value is the full level? 100 for per cent, 127 for MIDI, 255 for 8 bits.", "127"));
    if (!most) throw e;
    return call("import", {...source, intensity_max: most});
  }
}
// Returns the name and the text of a file's strokes; for other files throws their kind.
async function what_to_import(file) {
  const text = await file.text(), head = text.slice(0, 400), own = STROKE_OF_FIGURE.exec(text);
  if (own) return {name: "figure.toml", text: own[1].split(" ").map(part => new TextDecoder().decode(decoded(part))).join("")};
  if (head.includes("<!-- Drawn by tactor -->") || head.startsWith("%PDF") || head.slice(1).startsWith("PNG\r\n")) throw new Error(FIGURE);
  if (text.includes("\0") || /^\ufffd\ufffd/.test(head)) throw new Error(`it is not text; strokes are ${formats().map(f => f.title ?? f.name).join(", ")} or a plan`);
  if (file.size > MOST_BYTES) throw new Error(`it is larger than ${MOST_BYTES >> 10} KiB`);
  return {name: file.name, text};
}
listen("file", "change", () => { open_files([...by_id("file").files]); by_id("file").value = ""; });
addEventListener("dragover", e => e.preventDefault());
addEventListener("drop", e => {
  e.preventDefault();
  open_files([...e.dataTransfer?.files ?? []]);
});

// Returns a name that the service accepts: letters and digits of all languages, at most 100 bytes.
export function file_name(take) {
  let name = take.name.normalize("NFC").replace(/[^\p{L}\p{M}\p{N} _-]|[\x80-\xbf]/gu, "").trim().replace(/ +/g, "-").toLowerCase().replace(/^-+/, "");
  while (new TextEncoder().encode(name).length > 90) name = [...name].slice(0, -1).join("");
  return name || "take";
}
function give(name, type, ...parts) {
  const a = make("a", {download: name, href: URL.createObjectURL(new Blob(parts, {type}))});
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 10000);
}
export const give_toml = (name, text) => give(`${name}.toml`, "application/toml", text);
// Requests a take as a file from the service. Its gain becomes a part of the file if the format has it, else of the level.
const export_as = (take, as) => call("export", {...make_request(has_only_points(as) ? take : with_level(take)), as, name: file_name(take)});
const encoded = text => btoa(String.fromCharCode(...new TextEncoder().encode(text)));
const decoded = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

async function save_as(kind) {
  const take = current_take();
  if (!take?.strokes.length) return say("There is nothing to save yet");
  by_id("p-save").hidePopover();
  try {
    if (is_connected()) {
      const r = await export_as(take, kind), rest = rest_comment(take);
      const more = {toml: () => rest, svg: async () => `<!-- stroke of this figure: ${(await export_as(take, "toml")).base64} ${encoded(rest)} -->\n`};
      give(r.name, r.mime, decoded(r.base64), await more[kind]?.() ?? "");
    } else if (kind === "toml") give_toml(file_name(take), take_toml(take));
    else if (kind === "csv" && take.strokes.length === 1) give(`${file_name(take)}.csv`, "text/csv", stroke_csv(take.strokes[0]));
    else throw new Error("without a connection the page saves only TOML, and CSV of a single stroke");
    say(`Saved “${take.name}” as ${file_name(take)}.${kind}`);
  } catch (e) { say(fault_sentence(e)); }
}
// A browser may first ask if the page may save several files.
on_click("save-all", () => {
  const takes = state.takes.filter(t => t.strokes.length);
  for (const t of takes) give_toml(file_name(t), take_toml(t));
  say(`Saved ${takes.length} takes`);
});
function show_kinds() {
  const strokes = formats().filter(f => f.written).map(f => [f.name, ...FORMAT_WORDS[f.name] ?? [f.title, ""]]);
  by_id("save-list").replaceChildren(...[...strokes, ...OTHER_KINDS].map(([kind, name, why]) => make("button",
    {class: "save-item", "data-kind": kind, onclick: () => save_as(kind)}, make("b", {}, name),
    make("small", {}, why), make("span", {}, `.${kind}`))));
}
show_kinds();
let shown = null; // the greeting whose formats the list has
on_change(() => { if (state.hello !== shown) { shown = state.hello; show_kinds(); } }, "link");
listen("p-save", "beforetoggle", () => {
  const take = current_take();
  all_of("#save-list [data-kind]").forEach(b => { b.hidden = has_only_points(b.dataset.kind) && take?.strokes.length > 1; });
});
async function copy(id) {
  try { await navigator.clipboard.writeText(by_id(id).textContent); say("Copied"); } catch {
    getSelection().selectAllChildren(by_id(id));
    say("Selected; copy it with Ctrl C");
  }
}
all_of("[data-copy]").forEach(b => listen(b, "click", () => copy(b.dataset.copy)));

// Shows a link with the token for a phone, and its QR code if a phone can reach this server.
listen("p-share", "beforetoggle", async e => {
  if (e.newState !== "open") return;
  const own = is_own_host(location.hostname);
  by_id("qr").hidden = own;
  set_text("link", own ? `tactor serve --http 0.0.0.0:${location.port} --config FILE` : page_link());
  set_text("share-text", own ? "Only this computer can open this address. For a phone, start the service like this, with token_file under [serve] in FILE."
    : page_link().includes("#token=") ? "The link contains the token: anybody with the link can draw." : "Open it on a phone in the same network.");
  if (own) return;
  try {
    const {size, path} = await call("qr", {text: page_link()});
    by_id("qr").replaceChildren(make("svg", {viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": "QR code of the link",
      "shape-rendering": "crispEdges"}, make("path", {d: path, fill: "#000"})));
  } catch { by_id("qr").hidden = true; }
});
