# SPDX-License-Identifier: MIT
"""Support for the tests of tactor experiment: small definitions, the files of a session, and a terminal."""
import json
import pathlib
import re
import struct

import jsonschema
import terminal
from harness import TOOL, ToolTest
from studies import toml

COLUMNS = ("onset duration trial attempt motion method_1 method_2 response response_time early rating void xruns stream "
           "frame_1 frame_2 plan_1 plan_2").split()

SMALL = ('[experiment]\nname = "small"\ntitle = "A small one"\nauthors = ["A. Author"]\ngap_s = 0.25\n'
         + toml("motion", "to the right", path="M0 20H40", duration=0.7) + toml("motion", "down", path="M20 0V40", duration=0.7)
         + toml("method", "brush", algorithm="tactile-brush") + toml("method", "park", algorithm="park2016")
         + toml("run", "which-one", task="choose", attribute="similarity", animation=True, trials=4, practice=1, break_s=10)
         + toml("run", "how good", task="rate", attribute="similarity", trials=4, scale=7)
         + toml("run", "what", task="identify", trials=3, methods=["park"]))
# Three groups: one has all, one two of the runs, one a single cell of one run.
GROUPED = (SMALL + toml("group", "palm") + toml("group", "arm", runs=["which-one", "how good"])
           + toml("group", "few", runs=["how good"], motions=["down"], methods=["park"]))
DESK = """[array]
name = "desk"
grid = { rows = 1, columns = 2, pitch_mm = 20.0 }
"""
# Two motions by two methods, without a run, and without a consent question.
BARE = ('[experiment]\nname = "short"\narray = "desk.toml"\nlevel = { dbfs = -20 }\ngap_s = 0.1\n'
          + toml("motion", "east", path="M0 0H20", duration=0.2) + toml("motion", "west", path="M20 0H0", duration=0.2)
          + toml("method", "Alder", algorithm="tactile-brush") + toml("method", "Birch", algorithm="park2016"))
WITH_CONSENT = BARE.replace("gap_s = 0.1\n", 'gap_s = 0.1\nconsent = "Be at ease."\n')
SHORT = (WITH_CONSENT + toml("run", "pairs", task="choose", attribute="similarity", question="Which one?", animation=True, trials=2, practice=1, break_s=0.3)
         + toml("run", "marks", task="rate", attribute="uniformity", question="How even?", trials=2, scale=3, labels=["not", "half", "all"]))
# Ratings on a line, without numbers.
LINE = WITH_CONSENT + toml("run", "marks", task="rate", attribute="uniformity", question="How even?", trials=4, scale="vas", labels=["not", "all"])
# Estimates of any positive number.
ESTIMATES = BARE + toml("run", "size", task="estimate", question="How strong?", methods=["Birch"], motions=["east"], vary="level_dbfs", values=[-30, -20], trials=4)
# A place, and then a path, that the participant draws.
DRAWINGS = (BARE + toml("run", "where", task="locate", motions=["east"], methods=["Birch"], trials=3)
            + toml("run", "how", task="trace", motions=["east"], methods=["Birch"], trials=2))
# A level that the participant moves until it equals that of the standard.
ADJUST = BARE + toml("run", "equal", task="adjust", motions=["east"], methods=["Birch"], vary="level_dbfs", range=[-40, -20], steps=[1, 5], standard=-30,
                     start=[-40, -22], trials=4)
IDENTIFY = toml("run", "what", task="identify", trials=2, methods=["Birch"])


class ExperimentTest(ToolTest):
    def small(self, text=SMALL):
        self.write("small.toml", text)
        return "small.toml"

    def simulate(self, code="01", *more, definition=None, folder="study", spec="seed=1,sigma=1", status=0, says=()):
        """Runs a simulated session; with a status it must be refused."""
        args = ("experiment", definition or self.small(), "--participant", code, "-o", folder, "--simulate", spec, *more)
        return self.refused(status, *args, says=says) if status else self.ok(*args)

    def grouped(self, *people):
        """Simulates a session of each participant: a code and a group."""
        self.write("grouped.toml", GROUPED)
        for code, group in people:
            self.simulate(code, "--group", group, definition="grouped.toml")

    def analysis(self, *args):
        return json.loads(self.ok("analyze", "study", *args, "--format", "json").stdout)

    def rows(self, code, task, folder="study"):
        return read_table(self.dir / folder / f"sub-{code}/beh/sub-{code}_task-{task}_beh.tsv")

    def edit(self, name, *change):
        """Replaces a text in a file."""
        path = self.dir / name
        path.write_text(path.read_text().replace(*change))

    def forget_last_run(self, scans="study/sub-01/sub-01_scans.tsv"):
        """Removes the last table of a session and its line in the list of tables."""
        file = self.dir / scans
        *first, last = file.read_text().splitlines(True)
        (file.parent / last.split("\t")[0]).unlink()
        file.write_text("".join(first))

    def without_cut(self):
        """Returns the files except the part cut off a table."""
        return {n: b for n, b in contents(self.dir / "study").items() if ".cut-" not in n and n != ".bidsignore"}

    def frames_of_plan(self, name):
        return json.loads((self.dir / f"study/sourcedata/sub-01/plans/{name}.json").read_text())["render"]["frames"]

    def session(self, code="01", folder="study"):
        """Returns a session.json that its schema accepts."""
        facts = json.loads((self.dir / folder / f"sourcedata/sub-{code}/session.json").read_text())
        schema = json.loads((TOOL.parent / "schemas/tactor-session-1.schema.json").read_text(encoding="utf-8"))
        self.assertEqual([f"{list(e.absolute_path)}: {e.message[:200]}" for e in jsonschema.Draft202012Validator(schema).iter_errors(facts)], [])
        return facts


class PersonTest(ExperimentTest):
    def setUp(self):
        super().setUp()
        self.write("desk.toml", DESK)
        self.write("short.toml", SHORT)

    def args(self, *more, code="01", definition="short.toml", device="null"):
        return ("experiment", definition, "--participant", code, "-o", "study", *(("-D", device) if device else ()), *more)

    def answers(self, task="pairs", column="response"):
        return [(r["trial"], r["attempt"], r["void"], r[column]) for r in self.rows("01", task)]


def read_table(path):
    text = pathlib.Path(path).read_text(encoding="utf-8")
    assert text.endswith("\n"), text[-80:]
    head, *lines = (line.split("\t") for line in text[:-1].split("\n"))
    assert all(len(line) == len(head) for line in lines), path
    return [dict(zip(head, line)) for line in lines]


def noise_pieces(path):
    """Returns the length of each piece of noise at -20 dBFS in a file (S32, stereo), in 10 ms."""
    values = [v / 2 ** 31 for v, in struct.iter_unpack("<i", path.read_bytes())]
    left = values[::2]
    assert left == values[1::2]
    power = [sum(v * v for v in left[i:i + 480]) / 480 for i in range(0, len(left) - 479, 480)]
    assert power[0] == 0
    return [len(piece) for piece in re.findall("1+", "".join(str(int(0.7e-2 < p < 1.4e-2)) for p in power))]


def contents(folder):
    """Returns every file below a folder, hidden ones too: its name and bytes."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(pathlib.Path(folder).rglob("*")) if p.is_file()}


class Terminal(terminal.Terminal):
    def walk(self, agrees=True):
        if agrees:
            self.answer("Do you agree", "y")
        for i in (0, 1):
            self.answer(f"{i}: Did you feel it", "y")

    def begin(self, agrees=True, key=" "):
        """Answers up to the first run's first trial."""
        self.walk(agrees)
        self.answer("Any key begins", key)
