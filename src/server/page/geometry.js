// SPDX-License-Identifier: MIT
// Numbers, and places in the plane, [x, y].

export const clamp = (v, least, most) => Math.min(most, Math.max(least, v));
export const blend = (a, b, part) => a + (b - a) * part;
export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
// Returns f(0), f(1 / n), ..., f(1).
export const sampled = (n, f) => Array.from({length: n + 1}, (_, i) => f(i / n));

// Returns the convex hull of places, counter-clockwise in the mathematical sense.
export function hull(places) {
  const sorted = [...places].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = list => {
    const out = [];
    for (const p of list) {
      while (out.length > 1 && cross(out.at(-2), out.at(-1), p) <= 1e-9) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return [...half(sorted), ...half([...sorted].reverse())];
}
const cross = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

// Returns the distance of a place from a hull; 0 within.
export function outside_mm(edge, p) {
  if (edge.length < 3) return edge.length === 2 ? segment_mm(edge[0], edge[1], p) : 0;
  let off = Infinity, inside = true;
  edge.forEach((a, i) => {
    const b = edge[(i + 1) % edge.length];
    if (cross(a, b, p) < -1e-9) inside = false;
    off = Math.min(off, segment_mm(a, b, p));
  });
  return inside ? 0 : off;
}
// Returns the part of a segment at which a place is nearest to it.
function nearest_part(a, b, p) {
  const dx = b[0] - a[0], dy = b[1] - a[1];
  return Math.min(1, Math.max(0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
}
const nearest_on = (a, b, p) => [0, 1].map(k => blend(a[k], b[k], nearest_part(a, b, p)));
// Returns the distance of a place from a segment. Uses plain numbers, because this is most of a fit's work.
export function segment_mm(a, b, p) {
  const part = nearest_part(a, b, p), x = blend(a[0], b[0], part) - p[0], y = blend(a[1], b[1], part) - p[1];
  return Math.sqrt(x * x + y * y);
}
// Returns the place of a hull that is nearest to p.
export const within = (edge, p) => outside_mm(edge, p) === 0 ? p : edge.map((a, i) => nearest_on(a, edge[(i + 1) % edge.length], p))
  .reduce((best, q) => distance(q, p) < distance(best, p) ? q : best);

export function box(places) {
  const ends = (f, start) => [0, 1].map(k => places.reduce((v, p) => f(v, p[k]), start));
  const least = ends(Math.min, Infinity), most = ends(Math.max, -Infinity);
  return {least, most, size: most.map((v, k) => v - least[k]), middle: most.map((v, k) => (v + least[k]) / 2)};
}
