// SPDX-License-Identifier: MIT
import {by_id, make, show_only_if} from "../../../net/page/dom.js";

// Shows where the session is. The bar has a segment for each part; the present one fills with its trials.
export function show_progress(p, words, part_is_over) {
  const done = part_is_over ? p.trials : Math.max(0, p.trial - 1), parts = [];
  if (p.runs > 1 || !p.trial) parts.push(`${words.part} ${p.run} / ${p.runs}`);
  if (p.practice) parts.push(words.practice);
  if (p.trial) parts.push(`${p.trial} / ${p.trials}`);
  by_id("where").textContent = parts.join(" · ");
  const bar = by_id("bar");
  bar.setAttribute("aria-valuemax", p.trials);
  bar.setAttribute("aria-valuenow", done);
  bar.classList.toggle("practice", p.practice);
  while (bar.children.length > p.runs) bar.lastChild.remove();
  while (bar.children.length < p.runs) bar.append(make("i"));
  [...bar.children].forEach((segment, i) =>
    segment.style.setProperty("--done", i + 1 < p.run ? 1 : i + 1 === p.run ? done / p.trials : 0));
}
export function show_no_progress() { by_id("where").textContent = ""; }
export function show_bar_if(yes) { show_only_if(by_id("bar"), yes); }
