# SPDX-License-Identifier: MIT
"""tactor compare: figures, their forms and pictures, refusals in a row; and --spread: people who differ."""
import json
import math

from harness import main
from pictures import NS, PlotTest, Svg, number

ALGORITHMS = ("park2016", "tactile-brush", "continuous")
CENTROID = ("rms_error_mm", "largest_error_mm", "speed_cv", "intensity_cv", "silent_share", "shared_share")
PLACE = ("rms_to_path_mm", "rms_error_mm", "largest_error_mm", "along_rms_mm", "along_max_mm", "across_rms_mm", "across_max_mm")
LOW_SPEED = ("rms_error_mm", "largest_error_mm", "felt_length_mm", "target_length_mm", "length_ratio")
ASK = ("--observer", "low-speed")
MOVE = ("--compensate", "low-speed")
OFF_GRID = ("--path", "M 3 3 L 37 30", "--duration", "1")
TRACK = "t_s,x_mm,y_mm,intensity\n0,0,20,1\n0.3,20,20,0.4\n0.9017,20,30,0.9\n1.2,20,40,0.7\n"
# A stroke with its options, and the figures of the algorithms in order; tests/percept computes them in another way.
FIGURES = (
    ("park2016-1", ((2.094158, 5.352373, 0.684962, 0, 0, 0), (6.719758, 12.555396, 1.807182, 0.138711, 0, 0.741613),
                    (2.009797, 3.386220, 0.654958, 0, 0, 0))),
    ("park2016-2 --soa 0.06", ((2.130450, 4.757377, 0.676795, 0.699172, 0.328337, 0),)),
    ("park2016-3 --phantom barycentric", ((1.434269, 2.474896, 0.339043, 0, 0, 0), (7.240158, 12.555396, 1.736321, 0.143869, 0, 0.827701), (0,) * 6)),
    ("track.csv", ((1.541041, 4.6, 0.719288, 0.224585, 0, 0), (6.314212, 12.484269, 1.697252, 0.276346, 0, 0), (0, 0, 0.603690, 0.214470, 0, 0))),
    ("park2016-3 --observer low-speed", ((1.056065, 1.805183, 72.609458, 75.320732, 0.964004), (19.427591, 26.545642, 64.627637, 41.707524, 1.549544))),
    ("park2016-1 --observer low-speed --sigma-mm 8.5 --config slower.toml",
     ((1.793879, 3.714679, 39.636210, 50.213821, 0.789349), (14.894353, 21.876509, 31.661132, 22.644365, 1.398190))),
)


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


class CompareTest(PlotTest):
    def compare(self, *args):
        return json.loads(self.ok("compare", *args, "--format", "json").stdout)

    def picture(self, *args):
        self.ok("compare", *args, "-o", "c.svg")
        return Svg(self.dir / "c.svg")

    def said(self, svg):
        return " ".join(svg.texts())

    def tables(self, *args):
        """Returns the rows of the table of places and of that of times, each a list of words, and the text."""
        text = self.ok("compare", *args).stdout
        place, time = (part.splitlines() for part in text.split("\n\n")[1:3])
        return [[line.split() for line in lines if line.split(" ")[0] in ALGORITHMS] for lines in (place, time)], text


class Table(CompareTest):
    def test_figures_of_each_algorithm_and_observer(self):
        self.write("track.csv", TRACK)
        self.write("slower.toml", "[defaults]\nsigma-v-mm-s = 60\n")
        for args, rows in FIGURES:
            for result, algorithm, wanted in zip(self.compare(*args.split())["results"], ALGORITHMS, rows):
                self.assertEqual(result["algorithm"], algorithm)
                for name, value in zip(LOW_SPEED if "observer" in args else CENTROID, wanted, strict=True):
                    self.assertAlmostEqual(result[name], value, delta=1e-6, msg=f"{args} {algorithm} {name}")

    def test_errors_at_a_lag_and_from_the_path(self):
        wanted = {("park2016", "barycentric"): (1.43, 0.72, 0.0, 0.035), ("park2016", "inverse-distance"): (2.09, 1.69, 0.22, 0.035),
                  ("tactile-brush", "inverse-distance"): (6.72, 6.72, 4.02, 0.0)}
        rows = {(r["algorithm"], r["phantom"]): r for r in self.compare("park2016-1", "--phantoms", "inverse-distance,barycentric")["results"]}
        for row, (*errors, lag_s) in wanted.items():
            for name, value in zip(("rms_error_mm", "rms_at_lag_mm", "rms_to_path_mm"), errors, strict=True):
                self.assertAlmostEqual(rows[row][name], value, delta=0.02, msg=f"{row} {name}")
            self.assertAlmostEqual(rows[row]["lag_s"], lag_s, 9)
        for r in rows.values():
            self.assertAlmostEqual(math.hypot(r["along_rms_mm"], r["across_rms_mm"]), r["rms_error_mm"], 9)
            self.assertLessEqual(r["rms_at_lag_mm"], r["rms_error_mm"])

    def test_errors_of_taps_count_at_their_onsets(self):
        r = self.compare("park2016-1", *ASK)["results"][0]

        def target(t):  # half a circle round (20, 20), against the clock
            a = math.pi * max(0.0, t) / 1.4
            return 20 - 16 * math.sin(a), 20 - 16 * math.cos(a)

        taps = [(t["onset_s"], (t["felt_x_mm"], t["felt_y_mm"])) for t in r["taps"]]
        lags = [rms([math.dist(felt, target(t - by / 1000)) for t, felt in taps]) for by in range(201)]
        self.assertAlmostEqual(r["rms_at_lag_mm"], min(lags), 6)
        self.assertAlmostEqual(r["lag_s"], lags.index(min(lags)) / 1000, 9)
        off = [abs(math.dist(felt, (20, 20)) - 16) if felt[0] <= 20 else min(math.dist(felt, (20, y)) for y in (4, 36)) for _, felt in taps]
        self.assertAlmostEqual(r["rms_to_path_mm"], rms(off), 3)
        parts = [(math.pi * t / 1.4, felt[0] - target(t)[0], felt[1] - target(t)[1]) for t, felt in taps]
        self.assertAlmostEqual(r["along_rms_mm"], rms([y * math.sin(a) - x * math.cos(a) for a, x, y in parts]), 2)
        self.assertAlmostEqual(r["across_rms_mm"], rms([y * math.cos(a) + x * math.sin(a) for a, x, y in parts]), 2)

    def test_every_chosen_algorithm_with_every_chosen_phantom(self):
        c = self.compare("park2016-1", "--algorithms", "continuous,park2016", "--phantoms", "barycentric,linear")
        self.assertEqual((c["schema"], len(c["array"]["tactors"])), ("tactor-compare/1", 9))
        self.assertIn("not a measurement", c["note"])
        self.assertIn("reconstructed", c["stroke"]["note"])
        self.assertEqual([(r["algorithm"], r["phantom"], r["bursts"]) for r in c["results"]],
                         [("continuous", "barycentric", None), ("continuous", "linear", None), ("park2016", "barycentric", 21), ("park2016", "linear", 21)])
        self.write("c.toml", '[defaults]\nphantom = "log"\nalgorithm = "continuous"\nobserver = "low-speed"\nsigma-mm = 10\nsigma-v-mm-s = 50.0\n')
        c = self.compare("park2016-1", "--config", "c.toml")
        self.assertEqual([(r["algorithm"], r["phantom"]) for r in c["results"]], [(a, "log") for a in ALGORITHMS])
        self.assertEqual((c["observer"]["sigma_mm"], c["observer"]["sigma_v_mm_s"]), (10, 50))
        self.ok("plan", "park2016-1", "--config", "c.toml")
        self.assertEqual(len(self.compare("park2016-1", "--algorithm", "tactile-brush")["results"]), 1)

    def test_text_holds_the_same_figures(self):
        args = ("park2016-3", "--phantoms", "inverse-distance,gaussian")
        (places, times), text = self.tables(*args)
        for place, time, result in zip(places, times, self.compare(*args)["results"], strict=True):
            self.assertEqual(place, [result["algorithm"], result["phantom"], *(f"{result[f]:.3f}" for f in PLACE)])
            self.assertEqual(time, [result["algorithm"], result["phantom"], "-" if result["bursts"] is None else str(result["bursts"]),
                                    f"{1000 * result['lag_s']:.0f}", *(f"{result[f]:.3f}" for f in ("rms_at_lag_mm", *CENTROID[2:4])),
                                    *(f"{100 * result[f]:.1f}" for f in CENTROID[4:])])
        self.assertTrue(all(len(line) <= 80 for line in text.splitlines() if line[:4] in ("park", "tact", "cont")))
        self.assertEqual((text.count("not a measurement"), text.count("warning: tactile-brush")), (1, 1))

    def test_strokes_of_a_file_are_compared_each(self):
        self.write("two.toml", '[[stroke]]\nname = "a, b"\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
                               '[[stroke]]\nname = "c"\npath = "M 0 40 L 40 40"\nduration_s = 0.8\n')
        self.assertEqual([(x["stroke"]["name"], len(x["results"])) for x in self.compare("two.toml")["comparisons"]], [("a, b", 3), ("c", 3)])
        self.assertEqual(self.ok("compare", "two.toml").stdout.count("error mm"), 2)

    def test_every_output_names_the_observer_and_what_it_cannot_predict(self):
        args = ("park2016-1", *ASK, "--sigma-mm", "7.5", *self.defaults(sigma_v_mm_s=120))
        told, svg = self.compare(*args), self.picture(*args)
        self.assertEqual(told["observer"], {"name": "low-speed", "sigma_mm": 7.5, "sigma_v_mm_s": 120, "built_for": "taps"})
        text = self.ok("compare", *args).stdout
        for each in (text, told["note"], self.said(svg)):
            for word in ("low-speed", "7.5 mm", "120 mm/s", "built for taps", "nobody has fitted", "not a measurement"):
                self.assertIn(word, each)
        last = told["results"][2]
        self.assertEqual((last["refused"], last["rms_error_mm"]), (None, None))
        self.assertIn("no bursts", last["unpredicted"])
        self.assertIn("no prediction: continuous has no bursts", text)
        svg = self.picture("park2016-1", *ASK, "--algorithms", "continuous")
        self.assertTrue(any("no prediction" in t.text for t in svg.all("refused") if t.tag == NS + "text"))
        self.assertEqual(svg.all("chart"), [])

    def test_moved_bursts_are_predicted_and_named(self):
        exact = ("park2016-1", *ASK, "--phantom", "barycentric", "--algorithms", "park2016")
        plain, moved = self.compare(*exact), self.compare(*exact, *MOVE)
        self.assertIsNone(plain["compensated_for"])
        self.assertAlmostEqual(plain["results"][0]["rms_error_mm"], 0.346916, 6)
        self.assertEqual(moved["compensated_for"]["built_for"], "taps")
        self.assertLess(moved["results"][0]["rms_error_mm"], 1e-6)
        self.assertIn("no bursts", self.compare("park2016-1", *MOVE)["results"][2]["refused"])
        self.assertNotIn("Bursts are moved", self.said(self.picture("park2016-1")))
        for word in ("Bursts are moved", "low-speed", "sigma 5 mm", "sigma_v 100 mm/s", "built for taps"):
            self.assertIn(word, self.said(self.picture("park2016-1", *MOVE)))

    def test_a_comparison_names_its_faces(self):
        asked = ("park2016-1", "--faces", "nearest", "--phantoms", "inverse-distance,log")
        told = self.compare(*asked)
        self.assertEqual((told["faces"], [r["refused"] is None for r in told["results"]]), ("nearest", [True, False] * 3))
        self.assertIn("--faces: nearest works only with inverse-distance", told["results"][1]["refused"])
        self.assertIn("is not used", told["results"][2]["warnings"][0])
        self.assertNotIn("faces", self.compare("park2016-1"))
        self.assertIn(", faces nearest\n", self.ok("compare", *asked).stdout)
        self.assertIn("faces nearest", self.said(self.picture(*asked)))


class Pictures(CompareTest):
    def check_dots(self, panel, felt):
        """Checks that a panel has a dot at each place that is felt."""
        tactors = [(number(c, "cx"), number(c, "cy")) for c in panel.iter(NS + "circle") if c.get("class") == "tactor"]
        scale = (tactors[8][0] - tactors[0][0]) / 40
        dots = [(number(c, "cx"), number(c, "cy")) for c in panel.iter(NS + "circle") if c.get("class") == "felt-at"]
        for dot, place in zip(dots, felt, strict=True):
            self.assertLess(math.dist(dot, [c + scale * v for c, v in zip(tactors[0], place)]), 0.01)

    def test_bursts_are_drawn_where_they_are_felt(self):
        svg = self.picture("park2016-3")
        panels = svg.all("panel")
        self.assertEqual([p.get("data-algorithm") for p in panels], list(ALGORITHMS))
        plan = self.plan("park2016-3")
        at = {t["tactor"]: (t["x_mm"], t["y_mm"]) for t in plan["array"]["tactors"]}
        self.check_dots(panels[0], [[sum(d["amplitude"] ** 2 * at[d["tactor"]][c] for d in b["drives"]) for c in (0, 1)] for b in plan["bursts"]])
        self.check_dots(panels[2], [])
        for panel in panels:
            kinds = [e.get("class") for e in panel.iter()]
            self.assertEqual((kinds.count("start"), kinds.count("target")), (1, 1))
            self.assertEqual([e.text for e in panel.iter(NS + "text") if e.get("class") == "number"], [str(i) for i in range(9)])
        self.assertIn("felt", [e.get("class") for e in panels[2].iter()])
        taps = self.compare("park2016-3", *ASK)["results"][0]["taps"]
        self.check_dots(self.picture("park2016-3", *ASK).all("panel")[0], [(t["felt_x_mm"], t["felt_y_mm"]) for t in taps])

    def test_each_phantom_has_a_row_and_refusals_say_why(self):
        svg = self.picture(*OFF_GRID, "--phantoms", "inverse-distance,linear,gaussian")
        self.assertEqual((len(svg.all("panel")), len(svg.all("chart"))), (9, 3))
        self.assertTrue(any("refused" in t.text for t in svg.all("refused") if t.tag == NS + "text"))
        ids = [e.get("id") for e in svg.root.iter() if e.get("id")]
        self.assertEqual(len(ids), len(set(ids)))

    def test_png_and_pdf_are_written_and_impossible_pictures_refused(self):
        for name, begins in (("c.pdf", b"%PDF-"), ("c.png", b"\x89PNG")):
            self.ok("compare", "park2016-1", "-o", name, "--width", "120")
            self.assertTrue((self.dir / name).read_bytes().startswith(begins))
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 40 L 40 40"\n')
        for args in ("park2016-1 -o x.gif", "park2016-1 -o x.svg --width 5", "park2016-1 -o x.png --dpi 300.5", "two.toml -o x.svg"):
            self.refused(2, "compare", *args.split())
        self.assertEqual(list(self.dir.glob("x.*")), [])


class Refusals(CompareTest):
    def test_an_algorithm_that_cannot_play_the_stroke_says_why_in_its_row(self):
        rows = self.compare(*OFF_GRID)["results"]
        self.assertEqual((rows[0]["refused"], rows[2]["refused"]), (None, None))
        self.assertTrue("--snap" in rows[1]["refused"] and "rms_error_mm" not in rows[1])
        self.assertIn("tactile-brush inverse-distance refused: ", self.ok("compare", *OFF_GRID).stdout)
        self.assertIsNone(self.compare(*OFF_GRID, "--snap")["results"][1]["refused"])
        fast = ("park2016-3", "--duration", "0.12")
        self.assertIn("--drop-points", self.compare(*fast)["results"][1]["refused"])
        self.assertIn("left out", self.compare(*fast, "--drop-points")["results"][1]["warnings"][0])

    def test_a_stroke_that_none_can_play_is_bad_input(self):
        r = self.refused(2, "compare", "--path", "M 20 20 L 60 20")
        self.assertEqual((r.stdout, r.stderr.count("\n")), ("", 1))
        self.refused(2, "compare", *OFF_GRID, "--algorithms", "tactile-brush")
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 40 L 50 40"\n')
        r = self.refused(2, "compare", "two.toml", "--format", "json")
        self.assertEqual(len(json.loads(r.stdout)["comparisons"]), 2)

    def test_wrong_usage_is_refused(self):
        self.refused(2, "compare")
        for args in ("park2016-2", "--algorithms park2017", "--algorithms=", "--algorithms park2016,", "--phantoms log,log",
                     "--phantoms log --phantom log", "--format xml", "--soa 0.08", "--duration 3601", "--observer fast",
                     "--observer low-speed --sigma-mm 0", "--observer low-speed --sigma-mm 5mm",
                     "--sigma-mm 5", "--spread 1", "--spread 2.5", "--spread 1e9", "--spread many",
                     "--spread 5 --spread-sigma=0.5", "--spread 5 --spread-threshold-db=nan",
                     "--spread 5 --spread-place-mm=-2", "--spread-sigma 2", "--spread-threshold-db 2", "--spread-place-mm 2",
                     "--duration 3600 --spread 100000 -o c.svg --algorithms park2016"):
            with self.subTest(args):
                self.refused(2, "compare", "park2016-1", *args.split())
        for key, value in (("sigma_v_mm_s", 1e9), ("spread_seed", -1)):
            self.refused(2, "compare", "park2016-1", *self.defaults(**{key: value}))


class Spread(CompareTest):
    def test_intervals_are_those_of_the_people_drawn(self):
        told = self.compare("park2016-1", "--algorithms", "park2016", *ASK, "--spread", "60", *self.defaults(spread_seed=11), "--spread-sigma", "3",
                            "--spread-threshold-db", "4", "--spread-place-mm", "1.5")
        self.assertEqual(told["spread"], {"people": 60, "seed": 11, "sigma_factor": 3, "threshold_db": 4, "place_mm": 1.5,
                                          "parts": [0.05, 0.95]})
        # Quantiles by a second program. It draws by SplitMix64: for each person the factor of sigma, then for each tactor the
        # threshold, and the direction and distance of its place. tests/percept tests what a person with such differences feels.
        got = told["results"][0]["spread"]
        for name, ends in (("rms_error_mm", (2.041079583, 5.499169494)), ("length_ratio", (0.696786165, 1.190147127))):
            for end, wanted in zip(got[name], ends, strict=True):
                self.assertAlmostEqual(end, wanted, delta=1e-6, msg=name)
        self.assertIsNone(got["speed_cv"])

    def test_people_without_differences_feel_the_table_s_values(self):
        for observer in ("centroid", "low-speed"):
            told = self.compare("park2016-3", "--observer", observer, "--spread", "3", "--spread-sigma", "1",
                                "--spread-threshold-db", "0", "--spread-place-mm", "0")
            for row in told["results"]:
                for name, ends in (row["spread"] or {}).items():
                    for end in ends or ():
                        self.assertAlmostEqual(end, row[name], 9, f"{observer} {row['algorithm']} {name}")
            self.assertEqual([row["spread"] is None for row in told["results"]], [False, False, observer == "low-speed"])

    def test_wider_ranges_give_wider_intervals_and_seeds_the_same_people(self):
        def interval(*more):
            return self.compare("park2016-1", "--algorithms", "park2016", "--spread", "100", *more)["results"][0]["spread"]
        narrow, wide = interval("--spread-place-mm", "0.5", "--spread-threshold-db", "1"), interval()
        for name in ("rms_error_mm", "speed_cv", "intensity_cv"):
            self.assertLess(narrow[name][1] - narrow[name][0], wide[name][1] - wide[name][0])
        self.assertEqual(wide, interval(*self.defaults(spread_seed=1)))
        self.assertNotEqual(wide, interval(*self.defaults(spread_seed=2)))

    def test_text_and_picture_hold_the_same_and_state_the_ranges(self):
        for observer, figures in (("centroid", CENTROID[2:4]), ("low-speed", ("felt_length_mm", "length_ratio"))):
            args = ("park2016-1", "--observer", observer, "--spread", "50")
            spreads = [r["spread"] for r in self.compare(*args)["results"] if r["spread"]]
            text, svg = self.ok("compare", *args).stdout, self.picture(*args)
            for each in (text, self.said(svg)):
                for word in ("50 people", "seed 1", "6 dB", "2 mm"):
                    self.assertIn(word, each)
            self.assertEqual("sigma from 1/2 to 2" in text, observer == "low-speed")
            lines = [line.split() for line in text.splitlines() if line.lstrip().startswith(("5 %", "95 %"))]
            self.assertEqual(len(lines), 4 * len(spreads))
            for i, spread in enumerate(spreads):
                for end in (0, 1):
                    self.assertEqual(lines[2 * i + end][2:], [f"{spread[f][end]:.3f}" for f in PLACE])
                    self.assertEqual(lines[2 * (len(spreads) + i) + end][2:], [f"{1000 * spread['lag_s'][end]:.1f}",
                                     *(f"{spread[f][end]:.3f}" for f in ("rms_at_lag_mm", *figures))])
            bands, chart = svg.all("band"), svg.all("chart")[0]
            self.assertEqual((len(bands), len(svg.all("person"))), (len(spreads), 40 * len(spreads)))
            heights = [float(p.split(",")[1]) for p in bands[0].get("points").split()]
            self.assertGreater((max(heights) - min(heights)) / abs(float(chart.get("data-y-scale"))), 20)


if __name__ == "__main__":
    main()
