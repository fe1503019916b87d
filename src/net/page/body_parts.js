// SPDX-License-Identifier: MIT
// Outlines of parts of the body, and the place of an array on them.

// Outlines of parts of the body, mm. Hands: length 180 (men 189, women 172) and breadth 80.5 (86, 77), Ibeachu 2011 and Chan; fingers 51,
// 66, 74, 68, 55, thumb first, Chatzioglou and Govsa 2024 (49.5, 63.9, 70.7, 65.5, 53.3) x 1.035. Assumed, from common tables: forearm 245
// from crease to crease, wide 57 at the wrist and 90 at most; wrist 163 round, unrolled; index finger 17.6 wide; shoulders 380 wide, C7
// to waist 420. y points away from fingers and head. `at` is an array's usual place, from the middle of the wrist crease, of the palm side
// or of the pad, or from C7; `directions` are those of -y, -x, +y and +x on the left side. A mirrored outline is that of the right side.
const ARM = {sides: true, unit: 0.5, at: [0, 0], from: "the wrist crease", directions: ["hand", "thumb", "elbow", "little finger"]};
const HAND = {...ARM, box: [-88, -180, 176, 240], length: 180, measure: "hand length",
  directions: ["fingers", "thumb", "wrist", "little finger"], outline: " AnPP Q=OQP2O;G;A2C; FCQOMLEAGFIBNIQHVIWMYPVT\\YX[[]YY]fU?R=QC O"
      + "BQNNEO8N@M3SMTJWNWPVUSSUlQ`UgQ_Xr PCROPBQ5O?Q.RMVJWOWQVVRRRrPbRjP^ Q^ONY%QBT8Q@T1RNVKWOWRTVSSNoN`OhN\\ P_OO]5QCW>SCV9SNVMVPUSSURS"
      + "KhM]LcM\\KiVnPtNzItDlKfPl QdPQ"};
export const PARTS = { // the last entry that fits a site applies
  other: {find: /./, at: [0, 0], box: [-60, -60, 120, 120], length: 100, directions: []}, // without an outline
  palm: {...HAND, find: /palm|hand/i, at: [1, -56], lines: " >#P=_P_M GD!QQ^S]J!2.\\R\\K Vb!PR_S`M HB!RP]T^L!5']R\\M Tj!PP^S_P JB!QR]U]M!<"
      + "([T[N Ql!QO\\T]R LD!RR[V\\O!C-XT[Q #t!<P_E^D CN!PP_G[D ^x!ONyVbP \\NPO 0)!OQqNadZuQo L\\PP E.!OPtVn]tdge ;8!PP]bqUn[v^"},
  "back of hand": {...HAND, find: /dors|back/i, at: [0, -60], mirrored: true, lines: " <# P2QN[SXMP>MJFOHSLTVb ]H!OQ[UXMR=MJGNFSMSTc ^T"
      + "!NQZVXNS?NIHMGRLTRa \\\\!QRWVXNTEPHILHPLUP^ #i!%Q\\KVID=JMFUIYNTc` dL!RP]]Y@!`D\\^[B!aVY_\\C!_eV`\\E"},
  forearm: {...ARM, find: /arm/i, at: [0, 90], unit: 1, box: [-47, -70, 94, 380], length: 245, measure: "length",
    outline: " F>ORTuVdSZOpMx N\\ROLwNuPfQqPdM{PP gPQPPPM%P;R1O3M-L'J(M'O1SBVBT(",
    lines: "6PeSZPeM @} Pa!POnG]TrW E# PB!QQQ| Q]OP Q8!PPPrRz"},
  wrist: {...ARM, find: /wrist/i, from: "", box: [-81.5, -20, 163, 40], length: 163, measure: "round",
    outline: " 'FQP }P tPRPPP PdPPPP #P ,PNPPP P<PPPP", lines: " <FNP PdPP y<!PP PdPP .B!RN ]RPN ]NPQ"},
  fingertip: {...ARM, find: /finger|thumb/i, from: "", unit: 0.2, box: [-10, -13, 20, 75], length: 17.6, measure: "breadth",
    directions: ["tip", "thumb", "hand", "little finger"], outline: " D} PpPR Q7OPM(T(Q* PBNRQ)S2]8_F]P]P_Z]hSnQw P^NNQvTxMx QiOP",
    lines: " F_RQvXvH <m!RQxZxF D'!ROO;WQWOOe!7\\N&eGeYNz CS!QP O@PQt=tc O`PO"},
  back: {find: /^(?!.*(hand|arm|wrist)).*(back|torso)/i, at: [0, 200], from: "C7", unit: 2, box: [-224, -58, 448, 638], length: 420,
    measure: "C7 to waist", directions: ["head", "left", "feet", "right"], lines: "PP PdPQ PbPQP{ PbPQ J#!N$GpLyI`@0 fB!POYpTyW``0 =q!O"
      + "P T\\OR TDON",
    outline: " :} PlPNR3X6U6O;J*J,P;?aEIS4T5[:dHmIkDUFQ>PPlPPPQbUZk\\mWdX[fTkSlEW??PeJtJvOeUjXjRm"},
};
// Returns curves as a path. A point has two characters, relative to the point before: from "#" for -45 units to "}" for 45. After a space they
// count four times and do not make a point yet. Curves, after "!", are quadratic B-splines; a repeated point is a corner.
function read_path({unit}, text) {
  let at = [0, 0];
  return text.split("!").map(curve => {
    const points = curve.match(/ ?../g).flatMap(m => {
      at = at.map((v, k) => v + (m[2] ? 4 : 1) * unit * (m.at(k - 2).charCodeAt() - 80));
      return m[2] ? [] : [at];
    }), last = points.length - 1;
    return points.map((q, i) => i && i < last ? `Q${q} ${i + 1 < last ? q.map((v, k) => (v + points[i + 1][k]) / 2) : points[last]}`
      : (i ? "L" : "M") + q).join("");
  }).join("");
}
for (const p of Object.values(PARTS).slice(1)) Object.assign(p, {outline: read_path(p, p.outline), lines: read_path(p, p.lines)});

// A body is {part, right, x, y, turn, length}: the array's middle is x, y mm from the part's landmark, seen by a viewer. The body is turned
// under it, in degrees clockwise, and `length` mm long.
// Returns the usual place on a part.
export function usual_place(name, other_side) {
  const {at: [x, y], sides, length} = PARTS[name], right = !!(sides && other_side);
  return {part: name, right, x: right ? -x : x, y, turn: 0, length};
}
export const mirror = (part, right) => right === !part.mirrored ? -1 : 1;
export const outline_mm = ({part, length}) => length / PARTS[part].length; // mm of the body for each mm of the outline
export function directions(b) {
  const part = PARTS[b.part], d = part.directions;
  return mirror(part, b.right) < 0 ? [d[0], d[3], d[2], d[1]] : d;
}
// Returns the place of an array by its facts: its site, and its place, turn and body in the file.
export function find_body({site, up, ...own}) {
  const on = site ?? "left palm", usual = usual_place(Object.keys(PARTS).filter(name => PARTS[name].find.test(on)).pop(), /right/i.test(on));
  const {place: [x, y] = [usual.x, usual.y], body: length = usual.length, turn = 90 * Math.max(0, directions(usual).indexOf(up))} = own;
  return {...usual, x, y, turn, length};
}
// Returns the matrix that puts the outline under the middle of an array, at a scale.
export const body_matrix = (b, [x, y], scale) => new DOMMatrix().translate(x, y).rotate(b.turn).scale(scale).translate(-b.x, -b.y)
  .scale(outline_mm(b) * mirror(PARTS[b.part], b.right), outline_mm(b));
