# SPDX-License-Identifier: MIT
"""Strokes of files, and files of strokes, through the protocol of tactor serve."""
import base64
import math

from harness import ROOT, main
from serving import ServeTest

CIRCLE_SVG = '<svg xmlns="http://www.w3.org/2000/svg"><circle cx="20" cy="20" r="15"/></svg>'
TWO_SVG = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L20 0 M0 20 L20 20"/></svg>'
CSV = "t_s,x_mm,y_mm,intensity\n0,0,0,1\n0.5,20,10,0.5\n0.5,20,20,0.5\n1,40,40,1\n"
SEVERAL = """# two, and a group
[[stroke]]
name = "there"
path = "M 0 0 L 40 0"
duration_s = 0.5
[[stroke]]
name = "back"
timed = [[0, 40, 0], [0.25, 20, 20, 0.5], [1, 0, 40]]
start_from = "end"
start_s = 0.25
"""


class Import(ServeTest):
    def test_each_kind_of_text_becomes_strokes(self):
        c = self.serve().client()
        plan = self.ok("plan", "park2016-1", "--format", "json").stdout
        for name, text, count in (("a.toml", SEVERAL, 2), ("a.csv", CSV, 1), ("a.svg", TWO_SVG, 2), ("a.json", plan, 1),
                                  ("A.SVG", TWO_SVG, 2), ("a", SEVERAL, 2), ("a.txt", CSV, 1), ("", TWO_SVG, 2), ("a", plan, 1)):
            r = c.ok("import", name=name, text=text)
            self.assertEqual(list(r), ["toml", "strokes", "points", "warnings"])
            self.assertEqual((len(r["strokes"]), len(r["points"])), (count, count), name)
            self.assertEqual(c.ok("import", name=name, base64=base64.b64encode(text.encode()).decode()), r)
            for stroke, points in zip(r["strokes"], r["points"]):
                self.assertEqual((points[0][0], points[-1][0]), (0, stroke["duration_s"]))
            # The tool reads what it gives, and the same strokes are in it.
            again = c.ok("import", name="b.toml", text=r["toml"])
            self.assertEqual((again["strokes"], again["points"]), (r["strokes"], r["points"]))
            self.ok("plan", self.write("b.toml", r["toml"]))
        self.assertIn("a", c.ok("import", text=TWO_SVG, name="a.svg")["strokes"][0]["name"])

    def test_what_a_file_says_is_kept(self):
        c = self.serve().client()
        r = c.ok("import", name="a.toml", text=SEVERAL)
        self.assertEqual(r["toml"], SEVERAL)
        self.assertEqual(r["strokes"], [{"name": "there", "start_s": 0, "duration_s": 0.5},
                                        {"name": "back", "start_s": 0.75, "duration_s": 1}])
        self.assertEqual(r["points"], [[[0, 0, 0, 1], [0.5, 40, 0, 1]], [[0, 40, 0, 1], [0.25, 20, 20, 0.5], [1, 0, 40, 1]]])
        r = c.ok("import", name="a.csv", text=CSV)
        self.assertEqual(r["points"], [[[0, 0, 0, 1], [0.5, 20, 20, 0.5], [1, 40, 40, 1]]])
        self.assertIn("a.csv:4: repeats the time", r["warnings"][0])

    def test_a_curve_has_points_that_are_close_enough(self):
        c = self.serve().client()
        r = c.ok("import", name="circle.svg", text=CIRCLE_SVG)
        [points] = r["points"]
        for (_, x, y, _), (_, u, v, _) in zip(points, points[1:]):
            self.assertLess(abs(math.hypot((x + u) / 2 - 20, (y + v) / 2 - 20) - 15), 0.01)
        self.assertLess(len(points), 500)

    def test_fit_makes_strokes_as_large_as_the_array(self):
        c = self.serve().client()
        r = c.ok("import", name="circle.svg", text=CIRCLE_SVG, fit=True)
        xs = [p[1] for p in r["points"][0]]
        plan = self.plan(self.write("circle.svg", CIRCLE_SVG), "--fit")
        centre = plan["array"]["tactors"][4]
        self.assertAlmostEqual(max(xs) - centre["x_mm"], centre["x_mm"] - min(xs), 3)
        hull = [t["x_mm"] for t in plan["array"]["tactors"]]
        self.assertAlmostEqual(max(xs) - min(xs), max(hull) - min(hull), 3)
        c.ok("plan", toml=r["toml"])
        # Several are fitted as one picture, and the text says so.
        r = c.ok("import", name="a.toml", text=SEVERAL, fit=True)
        self.assertNotEqual(r["toml"], SEVERAL)
        self.assertEqual([s["start_s"] for s in r["strokes"]], [0, 0.75])
        self.assertEqual(c.ok("import", text=r["toml"])["points"], r["points"])

    def test_presets_and_shapes_become_points(self):
        c = self.serve().client()
        hello = c.ok("hello")
        self.assertEqual(hello["shapes"], ["tap", "line", "circle", "eight", "spiral"])
        for name in hello["presets"] + hello["shapes"]:
            r = c.ok("import", stroke=name)
            self.assertEqual([s["name"] for s in r["strokes"]], [name])
            c.ok("plan", toml=r["toml"], options={"outside": "clamp"})

    def test_a_repeated_group_keeps_its_starts(self):
        c = self.serve().client()
        group = "[[stroke]]\nrepeat = 2\npause_s = 1\n" + SEVERAL.replace("[[stroke]]", "[[stroke.stroke]]")
        r = c.ok("import", text=group)
        self.assertEqual([s["start_s"] for s in r["strokes"]], [0, 0.75, 2.75, 3.5])
        self.assertEqual(r["toml"], group)
        r = c.ok("import", text=group, fit=True)
        self.assertEqual([s["start_s"] for s in c.ok("import", text=r["toml"])["strokes"]], [0, 0.75, 2.75, 3.5])

    def test_faults_name_the_parameter_and_the_line(self):
        c = self.serve().client()
        for params, what, why in (({"name": "a.toml", "text": "[stroke]\npath = 'M 0 0 L 9 9'\nsoas = 1\n"}, "text", "3:1: "),
                                  ({"name": "a.csv", "text": "t_s,x_mm,y_mm\n0,0,0\n1,x,0\n"}, "text", "3:3: "),
                                  ({"name": "a.svg", "text": "<svg>\n<path d='M 0 x'/></svg>"}, "text", "2:"),
                                  ({"name": "a.json", "text": "{\n"}, "text", "line 2"),
                                  ({"name": "a.json", "text": "{}"}, "text", "no plan"),
                                  ({"text": "hello"}, "text", "1:"), ({"text": ""}, "text", ""),
                                  ({"base64": "aGVsbG8"}, "base64", "no base64"), ({"base64": "a b="}, "base64", "no base64"),
                                  ({"base64": base64.b64encode(b"\x89PNG\r\n\x1a\n").decode()}, "base64", "a PNG picture"),
                                  ({"base64": base64.b64encode(b"[stroke]\nname = '\xff'\n").decode()}, "base64", "2:"),
                                  ({"stroke": "nothing"}, "stroke", ""), ({}, "text", ""), ({"text": 1}, "text", ""),
                                  ({"text": CSV, "stroke": "tap"}, "text", ""), ({"text": CSV, "fit": 1}, "fit", ""),
                                  ({"text": CSV, "name": "x" * 256}, "name", ""), ({"text": CSV, "options": {}}, "options", "")):
            said = c.error("import", **params)
            self.check_error(said, -32602, what)
            self.assertIn(why, said["data"]["why"])

    def test_no_text_makes_the_server_open_a_file(self):
        c = self.serve().client()
        plan = self.ok("plan", "--path", "M 0 0 L 40 40", "--waveform", ROOT / "examples/strokes/comb.wav", "--format", "json").stdout
        toml = f'[stroke]\npath = "M 0 0 L 40 40"\nwaveform = "{ROOT}/examples/strokes/comb.wav"\n'
        for name, text in (("a.json", plan), ("a.toml", toml)):
            said = c.error("import", name=name, text=text)
            self.check_error(said, -32602, "text")
            self.assertIn("file", said["data"]["why"])
        # The name is only a name.
        self.write("there.toml", SEVERAL)
        self.check_error(c.error("import", name=str(self.dir / "there.toml"), text=""), -32602, "text")

    def test_limits_hold(self):
        c = self.serve(config="[serve]\nmax_strokes = 2\nmax_stroke_s = 10\nmax_message_bytes = 100000\n").client()
        line = "[[stroke]]\npath = 'M 0 0 L 40 40'\nduration_s = {}\n"
        self.check_error(c.error("import", text=line.format(1) * 3), -32001, "max_strokes")
        self.check_error(c.error("import", text=line.format(11)), -32001, "max_stroke_s")
        c.send({"jsonrpc": "2.0", "id": 1, "method": "import", "params": {"text": "#" * 100000}})
        self.check_error(c.reply()["error"], -32001, "max_message_bytes")


if __name__ == "__main__":
    main()
