// SPDX-License-Identifier: MIT
// Ground of the strokes: the body part, the skin between the tactors with its grid, the scale.
import {state} from "../state.js";
import {colour, paint, write, plot, disc} from "../look.js";
import {array, view, layers, start_layer, trace, to_px, handle_px} from "./view.js";
import {body, part, body_matrix, place_name, up_word} from "./body.js";

export function draw_ground() {
  const p = start_layer(layers.ground);
  p.fillStyle = colour("outside");
  p.fillRect(0, 0, view.width, view.height);
  if (!array) return;
  draw_body(p);
  const {least, most} = array.box;
  // The skin between the tactors, with a grid of 2 and 10 mm.
  p.save();
  trace(p, array.edge, true);
  paint(p, {fill: "skin"});
  p.clip();
  const step = view.scale * 2 < 5 ? 10 : 2;
  for (const [each, tone] of [[step, "grid"], [10, "grid2"]]) {
    p.beginPath();
    for (let x = Math.ceil(least[0] / each) * each; x <= most[0]; x += each) { p.moveTo(...to_px([x, least[1]])); p.lineTo(...to_px([x, most[1]])); }
    for (let y = Math.ceil(least[1] / each) * each; y <= most[1]; y += each) { p.moveTo(...to_px([least[0], y])); p.lineTo(...to_px([most[0], y])); }
    paint(p, {line: tone});
  }
  p.restore();
  trace(p, array.edge, true);
  paint(p, {line: "line2", width: 1.5});
  draw_scale(p);
  if (state.placing) draw_place(p);
  else if (array.up) {
    const [x, y] = to_px([array.box.middle[0], least[1] - array.radius]);
    write(p, `↑ ${up_word()}`, x, y - 7, "ink2");
  }
}
// Draws the part of the body that is under the array, to scale.
function draw_body(p) {
  const {outline, lines} = part(), whole = new Path2D(), within = new Path2D(), m = body_matrix(to_px(array.box.middle), view.scale);
  p.fillStyle = colour("hand");
  if (!lines) return p.fillRect(0, 0, view.width, view.height);
  whole.addPath(new Path2D(outline), m); within.addPath(new Path2D(lines), m);
  p.lineWidth = 1.5; p.strokeStyle = colour("handline");
  p.fill(whole); p.stroke(within);
  if (state.placing) p.strokeStyle = colour("ink3");
  p.stroke(whole);
}
// Draws the handle that turns the body, and a measure from the landmark.
function draw_place(p) {
  const far = handle_px(), down = -body.y * view.scale, {from} = part();
  p.save();
  p.translate(...to_px(array.box.middle)); p.rotate(body.turn * Math.PI / 180);
  disc(p, [0, -far], 20);
  paint(p, {fill: "raised", line: "ink", width: 1.5});
  write(p, "↻", 0, 5 - far, "ink", {size: 14, weight: 600});
  if (from) { p.stroke(new Path2D(`M${far - 28} 0h12v${down}h-12`)); p.fillText(`${Math.abs(body.y)} mm`, far + 16, down / 2 + 5); }
  p.restore();
}
function draw_scale(p) {
  const mm = [1, 2, 5, 10, 20, 50, 100].find(v => v * view.scale > 46) ?? 100, width = mm * view.scale;
  const x = view.scale_left, y = view.height - view.scale_bottom;
  plot(p, [x, y - 5], [x, y], [x + width, y], [x + width, y - 5]);
  paint(p, {line: "ink2", width: 1.5});
  write(p, `${mm} mm${view.width >= 760 ? `, ${place_name()}, to scale` : ""}`, x + width + 10, y, "ink2", {align: "left"});
}
