# SPDX-License-Identifier: MIT
"""--compensate: bursts moved for the low-speed observer, in every command that plans."""
import csv
import io
import json
import math
import xml.etree.ElementTree as ElementTree

from harness import ToolTest, main

SVG = "{http://www.w3.org/2000/svg}"
MOVE = ("--compensate", "low-speed")
EXACT = ("--phantom", "barycentric")
TAPS = ("low-speed", "sigma 5 mm", "sigma_v 100 mm/s", "built for taps")


def equations(onsets, places, sigma, sigma_v):
    """Computes (I + K) x of a chain."""
    out = [list(p) for p in places]
    for i in range(len(onsets) - 1):
        k = (sigma / (sigma_v * (onsets[i + 1] - onsets[i]))) ** 2
        for c in (0, 1):
            out[i][c] -= k * (places[i + 1][c] - places[i][c])
            out[i + 1][c] += k * (places[i + 1][c] - places[i][c])
    return out


class Compensate(ToolTest):
    def both(self, *args):
        r = self.ok(*args)
        return r.stdout + r.stderr

    def test_bursts_are_played_where_the_equations_put_them_and_felt_at_the_target(self):
        for sigma, sigma_v in ((5, 100), (8, 150)):
            args = ("park2016-3", *EXACT, "--sigma-mm", str(sigma), "--sigma-v-mm-s", str(sigma_v))
            plain, moved = self.plan("park2016-3", *EXACT), self.plan(*args, *MOVE)
            onsets = [b["onset_s"] for b in plain["bursts"]]
            asked = [(b["x_mm"], b["y_mm"]) for b in plain["bursts"]]
            for burst, place in zip(moved["bursts"], equations(onsets, asked, sigma, sigma_v)):
                self.assertLess(math.dist((burst["x_mm"], burst["y_mm"]), place), 1e-9)
            c = moved["compensation"]
            self.assertEqual((c["sigma_mm"], c["sigma_v_mm_s"], c["built_for"], c["bursts_at_edge"]),
                             (sigma, sigma_v, "taps", 0))
            self.assertLess(c["predicted_largest_mm"], 1e-6)
            for tap, place in zip(c["taps"], asked):
                self.assertLess(math.dist((tap["felt_x_mm"], tap["felt_y_mm"]), place), 1e-6)

    def test_at_the_edge_the_residual_is_reported_and_nothing_leaves_the_array(self):
        args = ("--path", "M 0 0 L 40 40 L 0 40", "--speed", "150", *EXACT, *MOVE)
        p = self.plan(*args)
        c = p["compensation"]
        self.assertGreater(c["bursts_at_edge"], 0)
        self.assertGreater(c["residual_rms_mm"], 0.1)
        self.assertAlmostEqual(c["residual_rms_mm"], c["predicted_rms_mm"], 9)
        self.assertTrue(all(-1e-6 <= b[n] <= 40 + 1e-6 for b in p["bursts"] for n in ("x_mm", "y_mm")))
        said = self.both("plan", *args)
        self.assertIn(f"{c['bursts_at_edge']} of {len(p['bursts'])} bursts cannot be moved far enough", said)
        self.assertIn(f"{c['residual_rms_mm']:.3f} mm RMS", said)

    def test_every_command_plays_the_same_and_names_the_model(self):
        args = ("park2016-1", *MOVE)
        (self.dir / "p.json").write_text(self.ok("plan", *args, "--format", "json").stdout)
        for command in (("plan", *args), ("plan", *args, "--format", "csv"), ("render", *args, "-o", "a.wav"),
                        ("play", *args, "-D", "null"), ("plot", *args, "-o", "a.svg"), ("compare", *args)):
            said = self.both(*command)
            for word in TAPS:
                self.assertIn(word, said, command)
        self.ok("render", "p.json", "-o", "b.wav")
        self.assertEqual((self.dir / "a.wav").read_bytes(), (self.dir / "b.wav").read_bytes())
        self.ok("render", "park2016-1", "-o", "c.wav")
        self.assertNotEqual((self.dir / "a.wav").read_bytes(), (self.dir / "c.wav").read_bytes())
        self.ok("render", "park2016-1", "--compensate", "none", "-o", "d.wav")
        self.assertEqual((self.dir / "c.wav").read_bytes(), (self.dir / "d.wav").read_bytes())
        self.assertEqual(self.ok("plan", "p.json", "--format", "json").stdout, (self.dir / "p.json").read_text())

    def test_each_line_of_a_table_names_it(self):
        for observer in ("centroid", "low-speed"):
            args = ("compare", "park2016-1", "--observer", observer, "--format", "csv")
            for line in csv.DictReader(io.StringIO(self.ok(*args, *MOVE, "--sigma-mm", "4").stdout)):
                self.assertEqual(list(line.items())[-3:], [("compensated_for", "low-speed"), ("compensated_sigma_mm", "4"),
                                                           ("compensated_sigma_v_mm_s", "100")])
            self.assertNotIn("compensated", self.ok(*args).stdout)

    def test_an_all_silent_plan_is_named_so_and_read_back(self):
        self.write("s.toml", '[stroke]\npath = "M 0 20 H 40"\nintensity = 0\n')
        text = self.ok("plan", "s.toml", *MOVE, "--format", "json").stdout
        self.write("p.json", text)
        self.assertIsNone(json.loads(text)["compensation"]["predicted_rms_mm"])
        self.assertEqual(self.ok("plan", "p.json", "--format", "json").stdout, text)
        said = self.both("plan", "s.toml", *MOVE)
        self.assertIn("no burst sounds that could be moved for the low-speed observer", said)
        self.assertNotIn("0.000 mm", said)

    def test_the_picture_shows_target_played_and_predicted(self):
        (self.dir / "p.json").write_text(self.ok("plan", "park2016-3", *MOVE, "--format", "json").stdout)
        plan = json.loads((self.dir / "p.json").read_text())
        for source in (("park2016-3", *MOVE), ("p.json",)):
            self.ok("plot", *source, "--view", "array", "-o", "a.svg")
            tree = ElementTree.parse(self.dir / "a.svg").getroot()
            array = next(e for e in tree.iter() if e.get("id") == "array")
            x0, y0, scale = (float(array.get(f"data-{n}")) for n in ("x0", "y0", "mm-scale"))
            rings = [e for e in tree.iter(SVG + "circle") if e.get("class") == "felt-at"]
            dots = [e for e in tree.iter(SVG + "circle") if e.get("class") == "burst"]
            taps = plan["compensation"]["taps"]
            self.assertEqual((len(rings), len(dots)), (len(taps), len(taps)))
            for ring, dot, tap, burst in zip(rings, dots, taps, plan["bursts"]):
                for mark, x, y in ((ring, tap["felt_x_mm"], tap["felt_y_mm"]), (dot, burst["x_mm"], burst["y_mm"])):
                    self.assertAlmostEqual(float(mark.get("cx")), x0 + scale * x, delta=0.02)
                    self.assertAlmostEqual(float(mark.get("cy")), y0 + scale * y, delta=0.02)
            text = " ".join(t.text for t in tree.iter(SVG + "text"))
            for word in ("target", "played", "predicted", "low-speed", "taps", "sigma 5 mm", "100 mm/s"):
                self.assertIn(word, text)

    def test_the_picture_of_a_comparison_says_that_bursts_were_moved(self):
        for more, moved in (((), False), (MOVE, True)):
            self.ok("compare", "park2016-1", *more, "-o", "c.svg")
            text = " ".join(t.text for t in ElementTree.parse(self.dir / "c.svg").getroot().iter(SVG + "text"))
            self.assertEqual(["Bursts are moved" in text, *(word in text for word in TAPS)], [moved] * (1 + len(TAPS)))

    def test_compare_predicts_moved_bursts(self):
        def row(*more):
            told = json.loads(self.ok("compare", "park2016-1", "--observer", "low-speed", *EXACT, "--algorithms",
                                      "park2016", "--format", "json", *more).stdout)
            return told["compensated_for"], told["results"][0]["rms_error_mm"]
        self.assertEqual(row()[0], None)
        self.assertAlmostEqual(row()[1], 0.346916, 6)
        self.assertEqual(row(*MOVE)[0]["built_for"], "taps")
        self.assertLess(row(*MOVE)[1], 1e-6)
        told = json.loads(self.ok("compare", "park2016-1", *MOVE, "--format", "json").stdout)
        self.assertIn("no bursts", told["results"][2]["refused"])

    def test_impossible_combinations_are_refused(self):
        self.refused(2, "plan", "park2016-1", "--compensate", "more")
        self.refused(2, "plan", "park2016-1", *MOVE, "--algorithm", "continuous")
        self.refused(2, "plan", "park2016-1", "--sigma-mm", "4")
        self.refused(2, "plan", "park2016-1", *MOVE, "--sigma-mm", "1000", "--sigma-v-mm-s", "0.001")
        (self.dir / "p.json").write_text(self.ok("plan", "park2016-1", *MOVE, "--format", "json").stdout)
        self.refused(2, "render", "p.json", *MOVE, "-o", "a.wav")
        broken = json.loads((self.dir / "p.json").read_text())
        broken["compensation"]["taps"][3]["felt_x_mm"] = "far"
        (self.dir / "q.json").write_text(json.dumps(broken))
        self.refused(2, "plot", "q.json", "-o", "a.svg")

    def test_it_may_be_a_default(self):
        self.write("c.toml", '[defaults]\ncompensate = "low-speed"\nsigma-mm = 3\n')
        self.assertEqual(self.plan("park2016-1", "--config", "c.toml")["compensation"]["sigma_mm"], 3)
        self.assertNotIn("compensation", self.plan("park2016-1", "--config", "c.toml", "--compensate", "none"))


if __name__ == "__main__":
    main()
