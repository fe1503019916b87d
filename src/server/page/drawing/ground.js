// SPDX-License-Identifier: MIT
// Ground of the strokes: the body part, the skin between the tactors with its grid, the scale.
import {colour, font} from "../look.js";
import {array, view, layers, start_layer, trace, to_px} from "./view.js";

export function draw_ground() {
  const p = start_layer(layers.ground);
  p.fillStyle = colour("outside");
  p.fillRect(0, 0, view.width, view.height);
  if (!array) return;
  draw_hand(p);
  const {least, most} = array.box;
  // The skin between the tactors, with a grid of 2 and 10 mm.
  p.save();
  trace(p, array.edge, true);
  p.fillStyle = colour("skin");
  p.fill();
  p.clip();
  const step = view.scale * 2 < 5 ? 10 : 2;
  for (const [each, tone] of [[step, "grid"], [10, "grid2"]]) {
    p.strokeStyle = colour(tone);
    p.lineWidth = 1;
    p.beginPath();
    for (let x = Math.ceil(least[0] / each) * each; x <= most[0]; x += each) { const [px] = to_px([x, 0]); p.moveTo(px, 0);
      p.lineTo(px, view.height); }
    for (let y = Math.ceil(least[1] / each) * each; y <= most[1]; y += each) { const [, py] = to_px([0, y]); p.moveTo(0, py);
      p.lineTo(view.width, py); }
    p.stroke();
  }
  p.restore();
  trace(p, array.edge, true);
  p.strokeStyle = colour("line2");
  p.lineWidth = 1.5;
  p.stroke();
  draw_scale(p);
  if (array.up) {
    p.font = font(12);
    p.fillStyle = colour("ink2");
    p.textAlign = "center";
    const [x, y] = to_px([array.box.middle[0], least[1] - array.radius]);
    p.fillText(`↑ ${array.up}`, x, y - 7);
  }
}
// Draws some of the body part around the array, where the array says that it is a palm.
function draw_hand(p) {
  const palm = /palm|hand/.test(array.site ?? "");
  const [w, h] = array.box.size.map(v => Math.max(v, array.pitch)), m = array.box.middle, left = /left/.test(array.site ?? "")
    ? -1 : 1;
  p.fillStyle = colour("hand");
  if (!palm) return p.fillRect(0, 0, view.width, view.height);
  const at = (x, y) => to_px([m[0] + left * x * w, m[1] + y * h]);
  p.strokeStyle = colour("handline");
  p.lineWidth = 1.5;
  const curve = (...c) => p.bezierCurveTo(...c.flatMap(([x, y]) => at(x, y)));
  p.beginPath();
  p.moveTo(...at(-1.02, -3));
  p.lineTo(...at(-1.02, -1.1));
  curve([-1.06, -0.4], [-1.02, 0.5], [-0.86, 1.1]);
  curve([-0.78, 1.5], [-0.76, 2], [-0.8, 3]);
  p.lineTo(...at(0.76, 3));
  curve([0.72, 2], [0.78, 1.5], [0.98, 1.15]);
  curve([1.4, 0.5], [1.7, 0], [2.2, -0.9]);
  p.lineTo(...at(1.9, -1.2));
  curve([1.5, -0.5], [1.3, -0.2], [1.12, -0.35]);
  curve([1.02, -0.5], [1.0, -0.9], [1.0, -3]);
  p.closePath();
  p.fill();
  p.stroke();
}
function draw_scale(p) {
  const mm = [1, 2, 5, 10, 20, 50, 100].find(v => v * view.scale > 46) ?? 100, width = mm * view.scale;
  const x = 18, y = view.height - view.scale_bottom;
  p.strokeStyle = colour("ink2");
  p.fillStyle = colour("ink2");
  p.lineWidth = 1.5;
  p.beginPath();
  p.moveTo(x, y - 5); p.lineTo(x, y); p.lineTo(x + width, y); p.lineTo(x + width, y - 5);
  p.stroke();
  p.font = font(12);
  p.textAlign = "left";
  p.fillText(`${mm} mm${array.site && view.width >= 760 ? `, ${array.site}` : ""}${view.width >= 760 ? ", to scale" : ""}`, x + width + 10, y);
}
