// SPDX-License-Identifier: MIT
// Ground of the strokes: the body part, the skin between the tactors with its grid, the scale.
import {state} from "../state.js";
import {colour, font} from "../look.js";
import {array, view, layers, start_layer, trace, disc, to_px, handle_px} from "./view.js";
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
  if (state.placing) draw_place(p);
  else if (array.up) {
    p.font = font(12);
    p.fillStyle = colour("ink2");
    p.textAlign = "center";
    const [x, y] = to_px([array.box.middle[0], least[1] - array.radius]);
    p.fillText(`↑ ${up_word()}`, x, y - 7);
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
  p.fillStyle = colour("raised"); p.fill();
  p.strokeStyle = p.fillStyle = colour("ink"); p.stroke();
  p.font = font(14, 600); p.textAlign = "center"; p.fillText("↻", 0, 5 - far);
  if (from) { p.stroke(new Path2D(`M${far - 28} 0h12v${down}h-12`)); p.fillText(`${Math.abs(body.y)} mm`, far + 16, down / 2 + 5); }
  p.restore();
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
  p.fillText(`${mm} mm${view.width >= 760 ? `, ${place_name()}, to scale` : ""}`, x + width + 10, y);
}
