// Sound for a page whose service has no card or plays to the null device: each tactor is a sound at its place.
import {state, changed, on_change, is_cardless, is_simulated, ceiling_dbfs, take_gain} from "../state.js";
import {by_id, on_click, set_text} from "../../../net/page/dom.js";
import {icon} from "../look.js";
import {array} from "../drawing/view.js";
import {distance} from "../geometry.js";
import {play, silence_speaker} from "./player.js";
import {start_tones} from "./loudspeaker.js";
import {open_example, try_entry} from "../takes/gallery.js";

let simulated = false, hinted = false, warned = false, tones = null;

on_click("hint-example", () => { if (simulated) try_entry(); else { open_example(); setTimeout(play, 0); } });
on_click("feel", () => {
  if (simulated) by_id("speaker").click(); else { state.feel = !state.feel; changed("tool"); }
});
on_change(() => {
  if (simulated !== is_simulated()) {
    state.speaker = simulated = is_simulated();
    silence_speaker();
    document.body.toggleAttribute("data-simulated", simulated);
    by_id("feel").firstChild.replaceWith(icon(simulated ? "speaker" : "feel"));
    set_text("hint-example", simulated ? "Hear where it moves" : "Play an example");
  }
  const on = simulated ? state.speaker : state.feel;
  by_id("feel").setAttribute("aria-checked", on);
  set_text("feel-text", `${simulated ? "Hear" : "Feel"} ${on ? "on" : "off"}`);
  const hint = by_id("hint");
  hint.hidden = state.takes.length || state.trial || state.drawing || !by_id("banner").hidden;
  const shown = !hint.hidden && by_id("hint-example").textContent; // the array makes room for these words
  if (shown !== hinted && !state.drawing) { hinted = shown; changed("layout"); } // the canvas never moves under a finger
  if (!warned && !by_id("banner").hidden) by_id("p-gallery").hidePopover(); // a new banner must be visible
  warned = !by_id("banner").hidden;
  hear_touches();
});

// Plays sounds where fingers draw or a tactor is tried. Near tactors have most of the energy of a place.
function hear_touches() {
  const touches = state.tapped >= 0 ? [[0, ...array.places[state.tapped], 1]]
    : state.drawing?.tracks.filter(k => k.down).map(k => k.points.at(-1)) ?? [];
  if (!simulated || !state.speaker || !touches.length) {
    if (tones) { tones.stop(); tones = null; if (is_cardless()) state.dbfs = []; }
    return;
  }
  const parts = array.places.map(() => 0);
  for (const [, x, y, strength] of touches) {
    const near = array.places.map(p => 1 / (distance(p, [x, y]) + 0.1) ** 4), sum = near.reduce((a, b) => a + b);
    near.forEach((v, i) => { parts[i] = Math.max(parts[i], strength * Math.sqrt(v / sum)); });
  }
  tones ??= start_tones(array.tactors);
  tones.set(parts, take_gain());
  if (is_cardless()) state.dbfs = parts.map(v => v > 0.01 ? ceiling_dbfs() + 20 * Math.log10(v * take_gain()) : null);
}
