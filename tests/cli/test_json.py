# SPDX-License-Identifier: MIT
"""JSON of every command against its schema and its page of the manual, each way: neither may know what the others do not.

Run as: python3 test_json.py TOOL SOURCE_ROOT FOLDER_OF_SCHEMAS JSON_SAMPLES
"""
import copy
import itertools
import json
import pathlib
import re
import subprocess
import sys

import jsonschema
from harness import ROOT, ToolTest, main, wav_bytes
import studies
from record import PAIR, STROKES

sys.path.insert(0, str(ROOT / "man"))
import write_fields  # noqa: E402

FOLDER = pathlib.Path(sys.argv[3]).resolve()
SCHEMAS = {schema["properties"]["schema"]["const"]: schema
           for schema in (json.loads(p.read_text()) for p in FOLDER.glob("tactor-*.schema.json")
                         if "protocol" not in p.name)}
SAMPLES = pathlib.Path(sys.argv[4]).resolve()
PAGE = (ROOT / "man/tactor-json.5").read_text(encoding="utf-8")

# Keys that an object may lack. All others are always there, null where there is no value.
OPTIONAL = {"tactor-plan/1": {"faces", "weakened_db", "meets", "render.together", "stroke.note", "stroke.fit", "continuous", "bursts[].tau_s", "compensation", "render.envelope", "array.tactors[].rise_s", "array.tactors[].displacement_um_at_0dbfs",
                              *(f"stroke.{key}" for key in ("waveform", "recording", "noise_seed", "texture", "texture_mm", "am_hz", "am_depth", "course", "course[].bend"))},
            "tactor-compare/1": {"faces", "stroke.note"},
            "tactor-session/1": {"streams[].pulses", "group", "session", "order_row", "hand", "rests_s", "codes", "predictions", "consent", "walk", "answers", "array.tactors[].rise_s", "array.tactors[].displacement_um_at_0dbfs",
                                 "calibration.tactors[].posterior_sd_db", *(f"codes.{key}" for key in ("channel", "bit_ms", "lines", "serial", "lsl", "numbers")), "stimuli[].level", "stimuli[].value"},
            "tactor-play/1": {"strokes[].weakened_db", "strokes[].meets"}, "tactor-check/1": {"walk"}, "tactor-experiment/1": {"stimuli[].level", "stimuli[].value", "session"}, "tactor-analysis/1": {"runs{}.groups", "runs{}.by", "runs{}.group_anova", "runs{}.methods", "runs{}.sessions", "runs{}.time_order"}}

GRID = '[array]\nname = "a"\ngrid = { rows = 3, columns = 4, pitch_mm = 15.0 }\n'
SOUNDS = ('[[stroke]]\npath = "M 0 0 L 10 0"\nduration_s = 0.5\nwaveform = "grain.wav"\ntexture = "length"\ntexture_mm = 5.0\n'
          '[[stroke]]\npath = "M 10 0 L 0 0"\nduration_s = 0.5\nwaveform = "noise:50-500"\nnoise_seed = 3\nam_hz = 20.0\n')
EASED = '[stroke]\npath = "M 0 0 L 10 0"\nduration_s = 0.5\neasing = "minimum-jerk"\ncarrier_profile = [[0, 100], [1, 300]]\n'
BRUSH = ("--array", "grid.toml", "--algorithm", "tactile-brush", "--path", "M 10 30 L 45 10")


# Objects whose keys are names given by users.
MAPS = {"rests_s", "answers", "codes.numbers", "runs", "void", "runs{}.response_time.by", "runs{}.preference.motion", "runs{}.chosen", "runs{}.chosen{}.motion",
        "runs{}.bradley_terry.log_worth", "runs{}.bradley_terry.se", "runs{}.means", "runs{}.means{}.motion", "runs{}.tukey",
        "runs{}.confusion", "runs{}.confusion{}", "runs{}.confusion{}{}", "runs{}.correct", "runs{}.correct{}.motion", "runs{}.pairs", "runs{}.groups",
        "runs{}.psychometric.participants", "runs{}.psychometric.mean", "runs{}.psychometric.tests", "runs{}.dprime.participants",
        "runs{}.exponent.participants", "runs{}.adjustment.participants", "runs{}.adjustment.means", "runs{}.time_order.participants", "runs{}.time_order.participants{}", "runs{}.time_order.means", "runs{}.drawings.participants", "runs{}.drawings.participants{}", "runs{}.drawings.means", "runs{}.drawings.predicted",
        "runs{}.scaling.participants", "runs{}.scaling.participants{}.places", "runs{}.scaling.places", "runs{}.by",
        *(f"runs{{}}.{key}" for factor in ("methods", "sessions") for key in (factor, factor + "{}.means", factor + "{}.group_means"))}


def member(at):
    """Returns the place of a member of a map. A group or a condition in a run is described as a run is."""
    return "runs{}" if at in ("runs{}.groups", "runs{}.by") else at + "{}"


def list_paths(value, at=""):
    """Returns the places in a value: "a", "a.b", "a[].b", "a{}.b"; "at" is that of the value itself."""
    if isinstance(value, dict) and at in MAPS:
        for v in value.values():
            yield from list_paths(v, member(at))
    elif isinstance(value, dict):
        for key, v in value.items():
            place = f"{at}.{key}" if at else key
            yield place
            yield from list_paths(v, place)
    elif isinstance(value, list):
        for v in value:
            yield from list_paths(v, at + "[]")


# An experiment at levels in dBFS, without an attribute and without noise.
FELT = ('[experiment]\nname = "felt"\nlevel = { dbfs = -18 }\n' + studies.toml("motion", "across", path="M0 20H40") + studies.toml("motion", "back", path="M40 20H0")
        + studies.toml("method", "park", level_dbfs=-20) + studies.run("which", "identify", 2)
        + studies.toml("run", "form", task="questionnaire") + 'item = [{ name = "age", question = "?", kind = "number", range = [0, 99] }]\n')

# Tasks that measure, with two conditions.
MEASURED = (FELT.partition("[[run]]")[0] + studies.toml("method", "soft", level_dbfs=-30)
            + studies.toml("run", "longer", task="constant", question="?", vary="length_mm", values=[4, 8], standard=6, trials_per_value=4)
            + studies.run("felt", "detect", 20, vary="level_dbfs", values=[-40, -30, -20], catch=0.2)
            + studies.run("some", "detect", 8, catch=0.5)
            + studies.run("same", "same-different", 16, methods=["park", "soft"])
            + studies.run("odd", "oddity", 12, methods=["park", "soft"], practice=1)
            + studies.run("size", "estimate", 8, question="?", vary="level_dbfs", values=[-30, -20])
            + studies.run("even", "adjust", 8, vary="level_dbfs", range=[-40, -10], standard=-20)
            + studies.run("place", "locate", 4))

# A task that measures, with three methods, three sessions and two groups.
THRICE = (FELT.partition("[[run]]")[0].replace("name", "sessions = 3\nname", 1) + studies.toml("method", "soft", level_dbfs=-30)
          + studies.toml("method", "hard", level_dbfs=-10) + studies.run("there", "detect", 24, catch=0.5)
          + '[[group]]\nname = "a"\n[[group]]\nname = "b"\n')

TRACKS = studies.run("climb", "adaptive", 12, question="?", vary="length_mm", procedure="1up1down", reversals=2, range=[4, 8], standard=6)

LINE = FELT.replace('task = "identify"', 'task = "rate"\nattribute = "even"\nquestion = "?"\nscale = "vas"\nlabels = ["no", "yes"]')


def paths_in(schema, at="", root=None):
    """Returns the same places of a schema."""
    root = root or schema
    if "$ref" in schema:
        schema = root["$defs"][schema["$ref"].rpartition("/")[2]]
    for key, v in schema.get("properties", {}).items():
        place = f"{at}.{key}" if at else key
        yield place
        yield from paths_in(v, place, root)
    if "items" in schema:
        yield from paths_in(schema["items"], at + "[]", root)
    for one in schema.get("oneOf", []):
        yield from paths_in(one, at, root)
    if isinstance(schema.get("additionalProperties"), dict) and member(at) == at + "{}":
        yield from paths_in(schema["additionalProperties"], at + "{}", root)


def objects_in(value, at=()):
    """Returns the keys to each object in a value."""
    if isinstance(value, dict):
        yield at
    for key, v in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from objects_in(v, at + (key,))


def copies_by_object(told):
    """Yields the place of each object in a value, and a copy of the value with the same object in it."""
    for keys in objects_in(told):
        changed = copy.deepcopy(told)
        inner = changed
        for key in keys:
            inner = inner[key]
        yield join_keys(keys), changed, inner


def shortened(value):
    """Returns the same with at most three members in each list of objects or lists."""
    if isinstance(value, dict):
        return {key: shortened(v) for key, v in value.items()}
    if isinstance(value, list):
        return [shortened(v) for v in value[:3]] if value and isinstance(value[0], (dict, list)) else value
    return value


def join_keys(keys):
    place = ""
    for k in keys:
        place = place + "[]" if isinstance(k, int) else member(place) if place in MAPS else f"{place}.{k}" if place else k
    return place


def paths_on_page(name):
    """Returns the fields that the page lists for a schema."""
    part = re.search(rf"^\.Ss {re.escape(name)}\n(.*?)(?=^\.S[sh] )", PAGE, re.M | re.S)[1]
    return [path for line in re.findall(r"^\.It Cm (.*)", part, re.M) for path in line.split(" , ")]


def split_runs(told):
    """Returns an analysis of each run alone, because the time to validate grows with the document; other output unchanged."""
    runs = told.get("runs")
    return [{**told, "runs": {name: run}} for name, run in runs.items()] if isinstance(runs, dict) else [told]


def own(paths):
    """Returns only the list of a list of plans or comparisons: its members have another schema."""
    return {p for p in paths if not p.startswith(("plans[]", "comparisons[]"))}


class Schemas(ToolTest):
    told = {}

    def setUp(self):
        super().setUp()
        self.write("pair.toml", PAIR)
        self.write("strokes.toml", STROKES)
        self.write("grid.toml", GRID)
        self.write("sounds.toml", SOUNDS)
        self.write("eased.toml", EASED)
        self.write("slow.toml", PAIR.replace("threshold_dbfs = -30", "rise_ms = 15\ndisplacement_um_at_0dbfs = 35"))
        (self.dir / "grain.wav").write_bytes(wav_bytes([0.5, 0.5, -0.5, -0.5] * 20))

    def outputs(self):
        """Maps the name of a schema to the tool's output; made once for all tests here."""
        if self.told:
            return self.told
        walk = self.run_tool("check", "--walk", "--array", "pair.toml", "-D", "null", "--format", "json", stdin="1\n0\n")
        self.write("o.toml", PAIR.partition("[sync]")[0])
        self.write("felt.toml", FELT)
        self.write("line.toml", LINE)
        self.write("meet.toml", 2 * "[[stroke]]\npath = 'M 0 20 L 40 20'\nduration_s = 0.5\nstart_s = 0\n")
        self.write("grouped.toml", FELT.replace("name", "sessions = 2\nname", 1) + '[[group]]\nname = "a"\n')
        self.ok("experiment", "grouped.toml", "--participant", "1", "-o", "grouped", "--simulate", "seed=1", "--group", "a", "--session", "1")
        self.write("apart.toml", studies.measures("palm-3x3", studies.toml("method", "hard", burst=0.02), studies.run("apart", "dissimilar", 12, attribute="similarity")))
        for code in ("1", "2"):
            self.ok("experiment", "apart.toml", "--participant", code, "-o", "apart", "--simulate", "seed=1")
        self.write("measured.toml", MEASURED + TRACKS)
        self.write("coded.toml", '[array]\npreset = "palm-3x3"\n[sync]\ncode = { channel = 9 }\n[sync.codes]\nstimulus = { by = ["motion", "method"] }\n')
        for code in "123":
            self.ok("experiment", "measured.toml", "--participant", code, "-o", "measured", "--simulate", f"seed={code},jnd=4,sigma=0.2,dprime=1")
        self.write("thrice.toml", THRICE)
        for code, session in itertools.product("123456", "123"):
            self.ok("experiment", "thrice.toml", "--participant", code, "--session", session, "--group", "a" if code < "4" else "b", "-o", "thrice", "--simulate", f"seed={code}")
        studies.grouped(self.dir / "compared")
        for study in ("missing", "three-by-three", "among"):
            studies.STUDIES[study](self.dir / study)
        texts = [self.ok(*args, "--format", "json").stdout for args in (
            ("plan", "park2016-3"), ("plan", "strokes.toml", "--fit", "--fit-margin", "1"), ("plan", "wave-2x4", "--fit"),
            ("plan", "--path", "M 1 1 L 9 9", "--duration", "0.01", "--algorithm", "continuous", "--ramp", "0.001"),
            ("plan", *BRUSH, "--duration", "1"), ("plan", "park2016-1", "--faces", "nearest"), ("plan", *BRUSH, "--duration", "0.15", "--drop-points"),
            ("plan", "strokes.toml", "--array", "pair.toml", "--sl", "7"), ("plan", "--path", "M 1 1 L 9 9", "--phase", "burst"),
            ("plan", "--path", "M 0 0 L 10 0", "--array", "pair.toml", "--sl", "7"),
            ("plan", "--path", "M 0 0 L 10 0", "--array", "slow.toml"), ("plan", "sounds.toml"), ("plan", "eased.toml"), ("plan", *BRUSH, "--duration", "1", "--overlap", "sum"), ("plan", *BRUSH, "--duration", "1", "--together", "sum"), ("plan", "meet.toml"), ("plan", "--path", "M 0 0 L 10 0", "--waveform", "noise:50-500", "--am", "20", "--envelope", "tukey"),
            ("plan", "--path", "M 0 0 L 10 0", "--waveform", "grain.wav", "--texture", "length", "--attack", "0.01", "--release", "0.02"),
            ("compare", "park2016-1"), ("compare", "park2016-1", "--faces", "nearest"), ("compare", "--path", "M 1 1 L 9 9"), ("compare", "strokes.toml", "--array", "o.toml"),
            ("compare", "park2016-1", "--observer", "low-speed", "--spread", "9"), ("compare", "park2016-1", "--spread", "5"),
            ("compare", "park2016-1", "--observer", "low-speed"), ("compare", "park2016-1", "--compensate", "low-speed"),
            ("plan", "park2016-1", "--compensate", "low-speed"),
            ("plan", "strokes.toml", "--array", "o.toml", "--compensate", "low-speed"),
            ("compare", "strokes.toml", "--array", "o.toml", "--observer", "low-speed"),
            ("experiment", "park2016", "--dry-run"), ("experiment", "felt.toml", "--dry-run"), ("experiment", "line.toml", "--dry-run"), ("experiment", "measured.toml", "--dry-run", "--array", "coded.toml"), ("experiment", "felt.toml", "--power", "2,3", "--studies", "4", "--simulate", "sigma=2"), ("experiment", "grouped.toml", "--power", "2", "--studies", "2", "--simulate", "sigma=2", "--group", "a"), ("experiment", "grouped.toml", "--dry-run", "--group", "a", "--session", "2"), ("analyze", "missing"), ("analyze", "three-by-three"), ("analyze", "among"), ("analyze", "grouped"), ("analyze", "measured"), ("analyze", "thrice"), ("analyze", "compared"), ("analyze", "apart"), ("devices",), ("devices", "--sample-format", "s16", "-D", "nowhere"), ("check", "-D", "null"),
            ("play", "--path", "M 0 0 L 1 0", "--duration", "0.1", "-D", "null"), ("play", "meet.toml", "-D", "null"))]
        more = json.loads(subprocess.run([SAMPLES], capture_output=True, text=True, check=True).stdout)
        sessions = [json.loads(p.read_text(encoding="utf-8")) for study in ("grouped/sourcedata/sub-1/ses-1", "measured/sourcedata/sub-1") for p in (self.dir / study).glob("session.json")]
        for one in [*map(json.loads, texts), json.loads(walk.stdout), *more, *sessions]:
            self.told.setdefault(one["schema"], []).append(one)
        return self.told

    def test_each_kind_of_output_has_a_schema_and_no_schema_lacks_one(self):
        self.assertEqual(set(self.outputs()), set(SCHEMAS))
        self.assertEqual(len(SCHEMAS), 11)
        for schema in SCHEMAS.values():
            jsonschema.Draft202012Validator.check_schema(schema)
            self.assertEqual(schema["$schema"], "https://json-schema.org/draft/2020-12/schema")

    def test_output_is_valid(self):
        for name, all_told in self.outputs().items():
            for told in all_told:
                errors = [f"{join_keys(e.absolute_path)}: {e.message[:200]}"
                          for e in jsonschema.Draft202012Validator(SCHEMAS[name]).iter_errors(told)]
                self.assertEqual(errors, [], name)

    def test_a_schema_refuses_unknown_missing_and_wrongly_typed_fields(self):
        for name, all_told in self.outputs().items():
            valid = jsonschema.Draft202012Validator(SCHEMAS[name]).is_valid
            seen = set()
            for told in itertools.chain.from_iterable(map(split_runs, map(shortened, all_told))):
                for place, changed, inner in copies_by_object(told):
                    # The same code describes objects with the same members, wherever they are.
                    shape = place.rpartition(".")[2] if place in MAPS else tuple(sorted(inner))
                    if shape in seen:
                        continue
                    seen.add(shape)
                    inner["unheard_of"] = {"a": "text"}
                    self.assertFalse(valid(changed), f"{name}: {place} may hold what is unknown")
                    del inner["unheard_of"]
                    for key in list(inner):
                        inside = re.sub(r"^(plans|comparisons)\[\]\.?", "", f"{place}.{key}".lstrip("."))
                        kept = inner.pop(key)
                        optional = inside in (OPTIONAL.get(name) or OPTIONAL.get(name.replace("s/", "/"), ())) or place in MAPS
                        self.assertEqual(valid(changed), optional, f"{name}: {place} without {key}")
                        inner[key] = {"another": {"type": "a text"}}
                        self.assertFalse(valid(changed), f"{name}: {place}.{key} of another type")
                        inner[key] = kept
                    self.assertTrue(valid(changed))

    def test_a_plan_that_its_schema_refuses_is_not_played(self):
        valid = jsonschema.Draft202012Validator(SCHEMAS["tactor-plan/1"]).is_valid
        seen = set()
        for told in self.outputs()["tactor-plan/1"]:
            for place, changed, inner in copies_by_object(told):
                for key in ["unheard_of", *inner]:
                    if (place, key) in seen:
                        continue
                    seen.add((place, key))
                    known, kept = key in inner, inner.pop(key, None)
                    for value in [-1e9, {"another": "type"}] if known else ["a text"]:
                        inner[key] = value
                        if not valid(changed):
                            self.assert_refused(changed, key)
                    del inner[key]
                    if not valid(changed):
                        self.assert_refused(changed, key)
                    if known:
                        inner[key] = kept
        self.assertGreater(len(seen), 120)

    def assert_refused(self, plan, key):
        self.write("changed.json", json.dumps(plan))
        said = self.run_tool("render", "changed.json", "-o", "o.wav")
        self.assertEqual((said.returncode, said.stdout), (2, ""), f"{key}: {said.stderr}")
        self.assertIn(key, said.stderr)

    def test_a_schema_has_no_field_that_is_never_printed(self):
        for name, all_told in self.outputs().items():
            printed = {path for told in all_told for path in list_paths(told)}
            self.assertEqual(own(paths_in(SCHEMAS[name])), own(printed), name)

    def test_members_of_a_list_are_the_same_objects_as_those_printed_alone(self):
        for several, key, one in (("plans", "plans", "plan"), ("compares", "comparisons", "compare")):
            alone = {k: v for k, v in SCHEMAS[f"tactor-{one}/1"].items() if k != "$schema"}
            self.assertEqual(SCHEMAS[f"tactor-{several}/1"]["properties"][key]["items"], alone)

    def test_the_page_describes_each_field_once(self):
        for name, schema in SCHEMAS.items():
            listed = paths_on_page(name)
            self.assertEqual(len(listed), len(set(listed)), name)
            self.assertEqual(set(listed), own(paths_in(schema)), name)

    def test_the_page_is_written_from_the_schemas(self):
        self.assertEqual(write_fields.written(PAGE, write_fields.read(FOLDER)), PAGE,
                         "python3 man/write_fields.py FOLDER/src/cli/schemas writes it")

    def test_names_that_are_not_utf_8_do_not_break_it(self):
        name = self.dir / "K\udcfcnstler.csv"
        name.write_text("t_s,x_mm,y_mm\n0,0,10\n1,40,30\n")
        for command in ("plan", "compare"):
            told = json.loads(self.ok(command, name, "--format", "json").stdout)
            self.assertEqual(told["stroke"]["name"], "K\ufffdnstler")


class Examples(ToolTest):
    """Runs the shipped files through every command that prints JSON of them."""

    def valid(self, *args):
        told = json.loads(self.ok(*args, "--format", "json").stdout)
        errors = [f"{join_keys(e.absolute_path)}: {e.message[:200]}" for e in jsonschema.Draft202012Validator(SCHEMAS[told["schema"]]).iter_errors(told)]
        self.assertEqual(errors, [], args)
        return told

    def test_strokes_and_arrays(self):
        strokes = [f for f in sorted((ROOT / "examples/strokes").iterdir()) if f.suffix in (".toml", ".csv", ".svg")]
        self.assertGreater(len(strokes), 10)
        for stroke in strokes:
            array = "palm-2x4" if "2x4" in stroke.name else "palm-3x3"
            self.valid("plan", stroke, "--array", array, "--fit")
            self.valid("compare", stroke, "--array", array, "--fit", "--spread", "2")
        arrays = [*sorted((ROOT / "examples/arrays").glob("*.toml")), *sorted((ROOT / "examples/rtp").glob("*.toml")), ROOT / "examples/tactor.toml"]
        self.assertGreater(len(arrays), 8)
        for array in arrays:
            self.valid("plan", "--shape", "circle", "--fit", "--array", array, "--algorithm", "continuous")
            self.assertEqual(json.loads(self.run_tool("check", "--array", array, "-D", "null", "--format", "json").stdout)["schema"], "tactor-check/1")

    def test_experiments(self):
        specs = {"numerosity": "jnd=0.14", "speed-jnd": "pse=76,jnd=14"}
        for file in sorted((ROOT / "examples/experiments").glob("*.toml")):
            text = file.read_text(encoding="utf-8")
            group = re.findall(r'^\[\[group\]\]\nname = "(.*)"', text, re.M)[:1]
            of = [*(("--group", *group) if group else ())]
            session = ["--session", "1"] if re.search("^sessions = ", text, re.M) else []
            spec = f"seed=1,{specs.get(file.stem, 'sigma=2')}"
            self.valid("experiment", file, "--dry-run", *of, *session)
            self.valid("experiment", file, "--power", "2", "--studies", "1", "--simulate", spec, *of)
            self.ok("experiment", file, "--participant", "01", "-o", file.stem, "--simulate", spec, *of, *session)
            self.valid("analyze", file.stem)


if __name__ == "__main__":
    main()
