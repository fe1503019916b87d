// SPDX-License-Identifier: MIT
// Elements of all pages.

const SVG_NAMES = "http://www.w3.org/2000/svg";

export const by_id = id => document.getElementById(id);
// Sets a text. Does nothing if it is the same: the browser would lay out the page again.
export function set_text(id, text) { if (by_id(id).textContent !== text) by_id(id).textContent = text; }
export const all_of = selector => document.querySelectorAll(selector);
// Listens to an element, which may be an id.
export function listen(to, event, f, options) { (typeof to === "string" ? by_id(to) : to).addEventListener(event, f, options); }
export const on_click = (id, f) => listen(id, "click", f);
export function show_pressed(e, is) { e.setAttribute("aria-pressed", is); }

// Makes an element: attributes, properties that begin with a dot, and listeners that begin with on.
export function make(tag, attributes = {}, ...children) {
  const svg = ["svg", "path", "rect", "circle", "line", "polyline", "g", "text"].includes(tag);
  const e = svg ? document.createElementNS(SVG_NAMES, tag) : document.createElement(tag);
  for (const [name, v] of Object.entries(attributes)) {
    if (v === undefined || v === null || v === false) continue;
    if (name.startsWith("on")) listen(e, name.slice(2), v);
    else if (name.startsWith(".")) e[name.slice(1)] = v;
    else e.setAttribute(name, v === true ? "" : v);
  }
  e.append(...children.flat().filter(c => c !== null && c !== undefined && c !== false));
  return e;
}

// Shows or hides an element by its attribute, because SVG has no property for it.
export function show_only_if(e, yes) { e.toggleAttribute("hidden", !yes); }
