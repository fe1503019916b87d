// SPDX-License-Identifier: MIT

export const by_id = id => document.getElementById(id);

// Makes an element with attributes and children.
export function element(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}
export function shape(name, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}
function fill(e, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
  e.append(...children);
  return e;
}

// Shows or hides; SVG has no property for it.
export function show_only_if(e, yes) { e.toggleAttribute("hidden", !yes); }
