# SPDX-License-Identifier: MIT
"""Strokes of files, and files of strokes, through the protocol of tactor serve."""
import base64
import itertools
import json
import math

from harness import ROOT, Wav, main
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
        for name, text, count in (("a.toml", SEVERAL, 2), ("a.csv", CSV, 1), ("A.SVG", TWO_SVG, 2), ("a.json", plan, 1),
                                  ("a", SEVERAL, 2), ("a.txt", CSV, 1), ("", TWO_SVG, 2), ("a", plan, 1)):
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
        self.assertEqual(r["strokes"], [{"name": "there", "start_s": 0, "duration_s": 0.5, "keys": {}},
                                        {"name": "back", "start_s": 0.75, "duration_s": 1, "keys": {}}])
        self.assertEqual(r["points"], [[[0, 0, 0, 1], [0.5, 40, 0, 1]], [[0, 40, 0, 1], [0.25, 20, 20, 0.5], [1, 0, 40, 1]]])
        r = c.ok("import", name="a.csv", text=CSV)
        self.assertEqual(r["points"], [[[0, 0, 0, 1], [0.5, 20, 20, 0.5], [1, 40, 40, 1]]])
        self.assertIn("a.csv:4: it has the same time", r["warnings"][0])
        group = "[[stroke]]\nrepeat = 2\npause_s = 1\n" + SEVERAL.replace("[[stroke]]", "[[stroke.stroke]]")
        r = c.ok("import", text=group)
        self.assertEqual([s["start_s"] for s in r["strokes"]], [0, 0.75, 2.75, 3.5])
        self.assertEqual(r["toml"], group)
        r = c.ok("import", text=group, fit=True)
        self.assertEqual([s["start_s"] for s in c.ok("import", text=r["toml"])["strokes"]], [0, 0.75, 2.75, 3.5])

    def test_a_client_learns_the_method_sound_and_level_of_each_stroke(self):
        c = self.serve().client()
        said = [{"algorithm": "continuous", "phantom": "log", "level_db": -3, "waveform": "noise:100-400", "noise_seed": 9, "am_hz": 30, "am_depth": 0.5},
                {"faces": "nearest", "soa_s": 0.06, "burst_s": 0.05, "carrier_hz": 200, "waveform": "square"},
                {"carrier_profile": [[0, 100], [1, 300]]}]
        text = "".join("[[stroke]]\npath = 'M 0 0 L 40 0'\n" + "".join(f"{k} = {json.dumps(v)}\n" for k, v in keys.items()) for keys in said)
        r = c.ok("import", name="a.toml", text=text)
        self.assertEqual([s["keys"] for s in r["strokes"]], said)
        for options, keys in (({"algorithm": "continuous", "phantom": "log"}, {}), ({"soa": 0.06, "burst": 0.03, "carrier": 200}, {"soa_s": 0.06, "burst_s": 0.03}),
                              ({"soa": 0.07}, {"soa_s": 0.07})):
            plan = base64.b64decode(c.ok("export", path="M 0 0 L 40 0", options=options, **{"as": "json"})["base64"]).decode()
            [found] = c.ok("import", name="plan.json", text=plan)["strokes"]
            usual = {"algorithm": "park2016", "phantom": "inverse-distance", "carrier_hz": 250, "waveform": "sine"}
            wanted = usual | {"algorithm": options.get("algorithm", "park2016"), "phantom": options.get("phantom", "inverse-distance"),
                              "carrier_hz": options.get("carrier", 250)} | keys
            self.assertEqual({k: v for k, v in found["keys"].items() if k not in ("am_hz", "am_depth")}, wanted)
        again = c.ok("import", text=c.ok("import", text=text, fit=True)["toml"])
        self.assertEqual([s["keys"] for s in again["strokes"]], said)

    def test_a_curve_has_points_that_are_close_enough_and_fits_the_array(self):
        c = self.serve().client()
        [points] = c.ok("import", name="circle.svg", text=CIRCLE_SVG)["points"]
        for (_, x, y, _), (_, u, v, _) in zip(points, points[1:]):
            self.assertLess(abs(math.hypot((x + u) / 2 - 20, (y + v) / 2 - 20) - 15), 0.01)
        self.assertLess(len(points), 500)
        r = c.ok("import", name="circle.svg", text=CIRCLE_SVG, fit=True)
        xs = [p[1] for p in r["points"][0]]
        hull = [t["x_mm"] for t in c.ok("hello")["array"]["tactors"]]
        self.assertAlmostEqual(min(xs), min(hull), 3)
        self.assertAlmostEqual(max(xs), max(hull), 3)
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

    def test_faults_name_the_parameter_and_the_line(self):
        c = self.serve().client()
        for params, what, why in (({"name": "a.toml", "text": "[stroke]\npath = 'M 0 0 L 9 9'\nsoas = 1\n"}, "text", "3:1: "),
                                  ({"name": "a.csv", "text": "t_s,x_mm,y_mm\n0,0,0\n1,x,0\n"}, "text", "3:3: "),
                                  ({"name": "a.svg", "text": "<svg>\n<path d='M 0 x'/></svg>"}, "text", "2:"),
                                  ({"name": "a.json", "text": "{\n"}, "text", "2:1: "),
                                  ({"name": "a.json", "text": "{}"}, "text", "it has no plan"),
                                  ({"name": "a.json", "text": '{"schema": "tactor-plan/1", "array": {"tactors": 7}}'}, "text", "text: algorithm: it is missing"),
                                  ({"text": "hello"}, "text", "1:"), ({"text": ""}, "text", ""),
                                  ({"base64": "aGVsbG8"}, "base64", "not base64"), ({"base64": "a b="}, "base64", "not base64"),
                                  ({"base64": base64.b64encode(b"\x89PNG\r\n\x1a\n").decode()}, "base64", "a PNG picture"),
                                  ({"base64": base64.b64encode(b"[stroke]\nname = '\xff'\n").decode()}, "base64", "2:"),
                                  ({"stroke": "nothing"}, "stroke", ""), ({}, "text", ""), ({"text": 1}, "text", ""),
                                  ({"text": CSV, "stroke": "tap"}, "stroke", ""), ({"text": CSV, "fit": 1}, "fit", ""),
                                  ({"text": CSV, "name": "x" * 256}, "name", ""), ({"text": CSV, "options": {}}, "options", "")):
            said = c.error("import", **params)
            self.check_error(said, -32602, what)
            self.assertIn(why, said["message"])
            self.assertNotIn("a.json", said["message"])

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


class Export(ServeTest):
    def export(self, client, kind, **params):
        """Exports and keeps the file; returns its bytes."""
        r = client.ok("export", **params, **{"as": kind})
        self.assertEqual(list(r), ["name", "mime", "base64", "warnings"])
        data = base64.b64decode(r["base64"], validate=True)
        self.write(r["name"], data)
        return data

    def made(self, command, stroke, output, *args):
        """Returns the bytes of the file that a command of the tool makes of a stroke file."""
        self.ok(command, stroke, *args, "-o", f"made-{output}")
        return (self.dir / f"made-{output}").read_bytes()

    def words(self, options):
        """Returns the options of a request that the exported stroke file does not have, as the tool's."""
        in_file = {"algorithm", "phantom", "faces", "soa", "burst", "carrier", "waveform", "noise_seed", "am", "duration", "speed"}
        for_file = {"slope", "intercept", "min_duration", "sigma_v_mm_s", "stevens_exponent", "spread_seed"}  # no command line takes them
        words = [(f"--{name.replace('_', '-')}", value) for name, value in options.items() if name not in in_file | for_file]
        if lines := [f"{name.replace('_', '-')} = {json.dumps(value)}\n" for name, value in options.items() if name in for_file]:
            self.write("rest.toml", '[array]\npreset = "palm-3x3"\n[defaults]\n' + "".join(lines))
            words.append(("--array", "rest.toml"))
        return list(itertools.chain(*words))

    def test_the_tool_makes_the_same_sound_of_the_exported_strokes(self):
        c = self.serve().client()
        drawn = {"points": [[0.25, 3, 4, 0.3], [0.5, 20.125, 17, 1], [0.8, 36, 31.7, 0.6], [1.1, 8, 39, 1]]}
        cubic = {"path": "M 0 10 C 20 -5 20 45 40 30 L 20 30"}
        strokes = ({"stroke": "park2016-3"}, {"stroke": "spiral"}, cubic, drawn, {"svg": TWO_SVG}, {"csv": CSV},
                   {"svg": CIRCLE_SVG, "fit": True}, {"toml": SEVERAL},
                   {"toml": "[[stroke]]\nrepeat = 2\n" + SEVERAL.replace("[[stroke]]", "[[stroke.stroke]]")})
        every = ({}, {"algorithm": "continuous", "phantom": "log", "level_dbfs": -20},
                 {"soa": 0.06, "burst": 0.05, "duration": 0.9, "carrier": 200, "am": "20:0.5", "faces": "nearest"},
                 {"speed": 70, "waveform": "noise:50-300", "noise_seed": 5, "envelope": "tukey:0.25", "timing": "fit",
                  "min_duration": 0.03, "intensity_scale": "stevens", "stevens_exponent": 0.9},
                 {"compensate": "low-speed", "sigma_mm": 8, "phantom": "barycentric", "outside": "clamp", "slope": 0.3, "soa": 0.06})
        for params, options in zip(strokes, itertools.cycle(every)):
            with self.subTest(params=params, options=options):
                wav = self.export(c, "wav", **params, options=options, name="a take-1")
                toml = self.export(c, "toml", **params, options=options, name="a take-1")
                self.assertEqual(self.made("render", "a take-1.toml", "a.wav", *self.words(options)), wav)
                # The strokes are exact: the exported file sounds like what it was made of.
                again = self.export(c, "wav", toml=toml.decode(), options=options, name="again")
                self.assertEqual(again, wav)

    def test_what_has_its_digits_sounds_as_it_is_played(self):
        c = self.serve().client()
        for params, arguments in (({"stroke": "park2016-3"}, ("park2016-3",)), ({"csv": CSV}, (self.write("b.csv", CSV),)),
                                  ({"path": "M 0 10 C 20 -5 20 45 40 30"}, ("--path", "M 0 10 C 20 -5 20 45 40 30"))):
            wav = self.export(c, "wav", **params)
            self.ok("render", *arguments, "-o", "c.wav")
            self.assertEqual((self.dir / "c.wav").read_bytes(), wav)

    def test_a_take_is_played_to_the_samples_of_its_file(self):
        server = self.serve(device=("-D", "raw:played.raw"))
        c = server.client()
        take = {"toml": "[[stroke]]\nname = 'drawn'\nstart_s = 0\ntimed = [[0, 3, 3, 0.4], [0.21, 20, 30.5, 1], [0.4, 38, 11]]\n",
                "options": {"soa": 0.06, "phantom": "barycentric", "outside": "clamp", "level_dbfs": -15}}
        told = c.ok("play", **take)
        c.await_end(told["stroke"])
        sample_format = c.ok("hello")["stream"]["format"]
        self.export(c, "toml", name="drawn", **take)
        server.terminate()
        self.ok("render", "drawn.toml", "--outside", "clamp", "--level-dbfs", -15, "--sample-format", sample_format, "-o", "drawn.wav")
        samples = Wav(self.dir / "drawn.wav").data
        self.assertGreater(sum(map(bool, samples)), 10000)
        self.assertIn(samples, (self.dir / "played.raw").read_bytes())

    def test_a_file_says_the_options_that_it_has_keys_for(self):
        c = self.serve().client()
        toml = self.export(c, "toml", path="M 0 0 L 40 40", name="up",
                           options={"algorithm": "continuous", "soa": 0.06, "level_dbfs": -15, "outside": "error"})
        self.assertEqual(toml.decode(), '[stroke]\nname = "path"\npath = "M 0 0 L 40 40"\nspeed_mm_s = 60\n'
                                        'algorithm = "continuous"\nsoa_s = 0.06\n')
        # A stroke's own key comes first.
        toml = self.export(c, "toml", toml='[stroke]\npath = "M 0 0 L 40 40"\nalgorithm = "park2016"\n',
                           options={"algorithm": "continuous"})
        self.assertIn('algorithm = "park2016"', toml.decode())
        r = c.ok("export", points=[[0, 0, 0], [1, 40, 40]], **{"as": "csv"}, options={"algorithm": "continuous"}, name="two words")
        self.assertEqual(base64.b64decode(r["base64"]), b"t_s,x_mm,y_mm,intensity\n0,0,0,1\n1,40,40,1\n")
        self.assertEqual((r["name"], r["mime"]), ("two words.csv", "text/csv"))
        self.assertEqual(c.ok("export", stroke="tap", **{"as": "toml"})["name"], "tap.toml")
        self.assertEqual(c.ok("export", toml='[stroke]\nname = "-a/b\\"\u00e9 "\npath = "M 0 0 L 9 9"\n',
                              **{"as": "toml"})["name"], "_a_b_\u00e9.toml")

    def test_the_owner_s_options_marks_and_limits_are_in_the_sound(self):
        for config, *args in (('[array]\nname = "desk"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                               '[output]\nrate = 44100\nchannels = 12\n[defaults]\nalgorithm = "continuous"\nlevel-dbfs = -30\n'
                               'speed = 20\nobserver = "low-speed"\nsigma-mm = 8\n', "--array", "serve.toml"),
                              ('[output]\nchannels = 10\n[sync]\nchannel = 9\n[serve]\nmax_level_dbfs = -12\n'
                               '[defaults]\nlevel-dbfs = -6\n', "--config", "serve.toml", "--level-dbfs", -12)):
            s = self.serve(config=config)
            c = s.client()
            wav = self.export(c, "wav", path="M 0 0 L 40 40", name="up")
            self.export(c, "toml", path="M 0 0 L 40 40", name="up")
            self.assertEqual(self.made("render", "up.toml", "up.wav", *args), wav)
            s.terminate()
        self.assertEqual(max(x[9] for x in Wav(self.dir / "up.wav").samples()), 1)

    def test_figures_are_those_of_plot_and_json_is_what_plan_gives(self):
        c = self.serve().client()
        for params in ({"stroke": "park2016-3", "options": {"soa": 0.06}}, {"toml": SEVERAL}):
            self.export(c, "toml", **params, name="take")
            for kind, mark in (("svg", b"<?xml"), ("png", b"\x89PNG"), ("pdf", b"%PDF")):
                picture = self.export(c, kind, **params, name="take")
                self.assertTrue(picture.startswith(mark))
                self.assertEqual(self.made("plot", "take.toml", f"take.{kind}"), picture)
        params = {"path": "M 0 0 L 40 30", "options": {"phantom": "barycentric"}}
        text = self.export(c, "json", **params)
        self.assertEqual(json.loads(text), c.ok("plan", **params))
        self.export(c, "toml", **params, name="path")
        self.assertEqual(self.plan("path.toml")["bursts"], json.loads(text)["bursts"])

    def test_bad_parameters_are_named(self):
        c = self.serve(config='[serve]\nmax_level_dbfs = -12\nmax_stroke_s = 100\n').client()
        path = {"path": "M 0 0 L 40 40"}
        for what, params in (("as", {**path}), ("as", {**path, "as": "mp3"}), ("as", {**path, "as": 1}), ("stroke", {"as": "wav"}),
                             ("as", {"toml": SEVERAL, "as": "csv"}), ("start", {**path, "as": "wav", "start": "now"}),
                             ("fit", {**path, "as": "wav", "fit": 1}), ("options.soa", {**path, "as": "wav", "options": {"soa": 0.5}}),
                             ("options.waveform", {**path, "as": "wav", "options": {"waveform": "a.wav"}}),
                             ("toml", {"toml": '[stroke]\npath = "M 0 0 L 9 9"\nwaveform = "a.wav"\n', "as": "toml"}),
                             ("path", {"path": "M 0 0 L 400 400", "as": "wav"})):
            self.check_error(c.error("export", **params), -32602, what)
        for name in ("", "../a", "a\u0000", "x" * 101, 1):
            self.check_error(c.error("export", **path, **{"as": "toml"}, name=name), -32602, "name")
        for kind in ("toml", "csv", "wav", "svg", "json"):
            self.check_error(c.error("export", **path, **{"as": kind}, options={"level_dbfs": -11.9}), -32602, "options.level_dbfs")
        self.check_error(c.error("export", points=[[0, 0, 0], [1, 20, 20, 1.1]], **{"as": "wav"}), -32602, "points")
        self.check_error(c.error("export", **path, **{"as": "wav"}, options={"duration": 101}), -32001, "max_stroke_s")


if __name__ == "__main__":
    main()
