# SPDX-License-Identifier: MIT
"""Runs every command that README, man pages, examples and --help show, except those listed below with a reason.

What a document's text and earlier commands make is there for the later ones. hw:CARD=Tactor is a null device here.
"""
import collections
import dataclasses
import os
import re
import shlex
import shutil
import subprocess
import sys

from harness import ALSA_CONFIG, PATIENCE_S, ROOT, TOOL, ToolTest, main
import studies

# Code in documents: commands, names of commands, and files, in the order of the text.
PROGRAMS = r"(?:\S*/)?(?:tactor|quickstart|run)|sudo|meson|man|c\+\+|cp|dpkg-\w+|grep|ulimit|kill|python3"


@dataclasses.dataclass
class Block:
    kind: str  # command, name (of a command of the tool), or what a block is: toml, csv, c++, python, unit, boot, cmake, drawing, formula, runner (a program for one)
    text: str
    line: int


def classify(text):
    """What a block of code is; whatever it is not known to be is commands."""
    for kind, pattern in (("c++", r"^#include|^const tactor::"), ("unit", r"^\[Service\]$"), ("toml", r"^\[+\w+\]+$"), ("csv", r"^t_s,"), ("boot", r"^dtoverlay="), ("cmake", r"^find_package\("), ("r", r"^\w+ <- "),
                          ("drawing", r"-->"), ("runner", r"PsychPortAudio|Tactor\(|jsPsych|TactorDevice|tactor\.hello"),
                          ("formula", r"^(?:[A-Za-z_]\w*(?:\(\w\))? = |polarity \* )")):
        if re.search(pattern, text, re.M):
            return kind
    return "command"


def commands_in(text, line):
    """Returns the commands of a manual's block: a backslash continues a line, two spaces outside quotes begin an
    explanation."""
    joined, number = "", line
    for offset, part in enumerate(text.split("\n")):
        number = number if joined else line + offset
        joined += part.strip() if joined else part.rstrip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        if joined and not joined.startswith((" ", "#")):  # an indented line continues an explanation
            # Two quotes or none before the gap.
            command = re.match(r"""((?:[^"' ]|"[^"]*"|'[^']*'| (?! ))+)""", joined)[1]
            yield Block("command", command, number)
        joined = ""


def inline(code, line):
    """Classifies code within a sentence: a command with arguments, a name without."""
    if not re.match(rf"(?:{PROGRAMS}) \S", code):
        return []
    name = re.fullmatch(r"tactor [\w-]+", code)
    return [Block("name" if name else "command", code, line)]


def copied_lines(text, line):
    """Returns the commands of a block as a reader copies them: whole lines with their explanations."""
    found, open_line = [], False
    for i, part in enumerate(text.split("\n")):
        if open_line:
            found[-1] = Block("command", found[-1].text.removesuffix("\\") + part.strip(), found[-1].line)
        elif part.strip():
            found.append(Block("command", part.rstrip(), line + i))
        open_line = part.endswith("\\")
    return found


def code_in_block(text, line, commands=commands_in):
    kind = classify(text)
    return commands(text, line) if kind == "command" else [Block(kind, text, line)]


def code_of_markdown(text):
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        if lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            end = at
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            yield from code_in_block("\n".join(part[4:] for part in lines[at:end]).rstrip("\n") + "\n", at + 1, copied_lines)
            at = end
            continue
        end = at + 1
        while lines[at].strip() and end < len(lines) and lines[end].strip():
            end += 1
        paragraph = "\n".join(lines[at:end])
        for code in re.finditer(r"`([^`]+)`", paragraph):  # may continue over the end of a line
            yield from inline(" ".join(code[1].split()), at + 1 + paragraph.count("\n", 0, code.start()))
        at = end


def plain(text):
    """Replaces escapes of roff by the characters that they print."""
    for escape, character in (("\\(dq", '"'), ("\\(aq", "'"), ("\\-", "-"), ("\\&", ""), ("\\e", "\\")):
        text = text.replace(escape, character)
    return text


def code_of_man(text, sentences=True):
    """Returns the code of a page; `sentences`: also from its sentences."""
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        line = lines[at]
        if line.startswith(".Bd -literal"):
            end = lines.index(".Ed", at)
            block = plain("\n".join(lines[at + 1:end]) + "\n")
            yield from code_in_block(block, at + 2)
            at = end
        elif line.startswith(".Dl "):
            yield from code_in_block(plain(line[4:]), at + 1)
        elif line.startswith(".Ic ") and sentences:
            yield from inline(plain(line[4:]), at + 1)
        at += 1


def code_of_script(text):
    """Returns commands of the tool in comments: indented, a line each."""
    for number, line in enumerate(text.split("\n"), 1):
        if command := re.match(r"# {2,}(tactor .*)", line):
            yield Block("command", command[1], number)

# The card that the documents name.
CARD = """
pcm.hw {
    @args [ CARD DEV SUBDEV ]
    @args.CARD { type string }
    @args.DEV { type string default "0" }
    @args.SUBDEV { type string default "0" }
    type null
}
"""
GUIDE = sorted((ROOT / "man/guide").glob("*.md"))
# Beginnings of commands that are run. A command that is neither here nor below fails.
RUN = ("tactor ", "build/src/cli/tactor ", "man -l man/", "python3 -m jsonschema ", "printf ", "for ", "seq ")
# Commands, by how they begin, that are not run here, and why.
NOT_RUN = {
    "sudo ": "needs root and changes the system",
    "TACTOR_SOAK=whole nice build/tests/study/test-study ": "simulates for minutes what the suite simulates for seconds",
    "python3 tests/study/error_rates.py ": "the lane statistics runs it, for minutes",
    "build/tests/study/test-study ": "the suite runs it",
    "/usr/bin/python3 -m venv": "the lane tests/lanes/python makes one",
    "~/tactor-venv/bin/pip ": "the lane tests/lanes/python installs the package",
    "tactor play STROKE --array both.toml ": "tests/machines/rtp.py plays the array over PipeWire",
    "python3 examples/python/two_machines.py": "the lane tests/lanes/python runs it",
    "tactor experiment examples/experiments/drawings.toml --participant P01": "needs a participant; tests/page draws",
    "rm -rf strokes/sub-P07": "there is no such study here",
    "sed -i '/^sub-P07": "there is no such study here",
    "rm P07.toml": "there is no such study here",
    "git clone": "needs the network, and the address of the repository",
    "apt-get update": "needs root and the network",
    "examples/quickstart": "installs packages and builds: needs root and the network",
    "tests/run": "would run this test",
    "meson compile -C build docs": "the suite docs does it",
    "meson compile -C build": "the lane tests/lanes/deb builds with the service",
    "meson setup small": "the lane tests/lanes/small does it",
    "meson configure build -Dservice=true": "the lane tests/lanes/deb builds with the service",
    "c++ ": "the suite install compiles it against an installed library",
    "cp -r examples/debian": "the lane tests/lanes/deb does it",
    "dpkg-buildpackage": "the lane tests/lanes/deb does it",
    "echo performance | sudo tee": "changes this machine's processors",
    "grep . /sys/module/pinctrl": "needs the kernel of a Raspberry Pi",
    "tactor off": "needs the GPIO line of an amplifier: the suite cli-off runs it as far as that",
    "tactor play park2016-1 park2016-3 park2016-1 --arm": "waits for a button at a GPIO line",
    "tactor stop": "needs a server: the suite cli-remote runs it",
    "tactor status": "needs a server: the suite cli-remote runs it",
    "tactor play park2016-3 --socket": "needs a server: the suite cli-remote runs it",
    "(echo 20 20; sleep": "the suite cli-remote does the same without sleeping",
    "tactor serve": "goes on until it is ended: the suite cli-serve runs it",
    '{"': "is a line of the service's protocol: the suite cli-serve speaks it",
    "mcs ": "the lane tests/lanes/clients compiles it",
    "mono ": "the lane tests/lanes/clients runs it",
    "oscsend": "needs a server: the suite cli-serve_osc runs it",
    "echo '{": "needs a server: the suite cli-serve says the same",
    "ulimit ": "says what step 4 of the page has changed",
    "kill -9": "is part of a sentence: which process is not said",
}
# Commands that run with a replacement for something missing here: (pattern, replacement, why).
SOMEBODY = [(r"^((?:build/src/cli/)?tactor calibrate .*)-D hw:CARD=Tactor", r"\1--simulate threshold=-45", "there is nobody to answer"),
            (r"^((?:build/src/cli/)?tactor experiment (?!.*--check-noise).*)-D hw:CARD=Tactor", r"\1--simulate seed=1", "there is nobody to answer"),
            (r" --page 4004$", "", "and nobody to look at a page")]
INSTEAD = dict.fromkeys(["README.md", *(f"man/guide/{page.name}" for page in GUIDE)],
                        SOMEBODY + [(r"--(http|osc|bhaptics) (400\d|9001|15881)", r"--\1 0", "the port may be somebody else's")]) | {
    "man/tactor-calibrate.1": [*SOMEBODY, (r" --array P07.toml(?= -o P07-again)", "", "P07.toml is made by a later example")],
    "man/tactor-experiment.1": SOMEBODY,
    "tactor calibrate --help": SOMEBODY,
    "tactor experiment --help": SOMEBODY,
    "man/tactor-raspberry-pi.7": [
        (r"^tactor (play|check)(?!.*--no-gpio)", r"tactor \1 --no-gpio", "the GPIO lines of a Raspberry Pi are left alone"),
        (r" --require-realtime", "", "rights of step 4 are not asked for"),
        (r"/tmp/", "pi-", "the test's own folder"),
    ],
    "man/tactor-json.5": [(r"/usr/local/share/tactor/", str(TOOL.parent / "schemas") + "/", "schemas of the build")],
}
# Files that documents name and that are in the sources.
FILES = {
    "man/guide/questions.md": {"felt.toml": "examples/arrays/palm-measured.toml", "left.wav": "examples/strokes/comb.wav", "right.wav": "examples/strokes/comb.wav"},
    "man/guide/study.md": {"felt.toml": "examples/arrays/palm-measured.toml"},
    "man/tactor-check.1": {"palm.toml": "examples/arrays/palm-measured.toml"},
    "man/tactor-options.7": {"palm.toml": "examples/arrays/palm-measured.toml"},
    "man/tactor-play.1": {"palm.toml": "examples/arrays/palm-measured.toml", "curve.toml": "examples/strokes/curve.toml"},
    "man/tactor.toml.5": {"arrays/palm.toml": "examples/arrays/palm-measured.toml"},
}
# Answers for --walk: all is wired correctly.
ANSWERS = "".join(f"{k}\n" for k in range(16))


def list_anchors(page):
    """Returns the anchors of a page's headings, as forges make them."""
    return [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)]


class Documents(ToolTest):
    counts = collections.Counter()

    @classmethod
    def tearDownClass(cls):
        c = cls.counts
        print(f"commands of documents: {c['run']} run as written, {c['instead']} with something in place of hardware or rights, "
              f"{c['not run']} not run (see above)")

    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + CARD)
        for place, program in (("bin/tactor", str(TOOL)), ("build/src/cli/tactor", str(TOOL)), ("bin/python3", sys.executable)):
            self.write(place, f'#!/bin/sh\nexec {shlex.quote(program)} "$@"\n').chmod(0o755)
        for folder in ("man", "examples"):
            (self.dir / folder).symlink_to(ROOT / folder)
        for study in ("study", "STUDY", "DIR"):  # as analyze's page and the README call a study's folder
            studies.simulated(self.dir / study)
        self.env |= {"PATH": f"{self.dir}/bin:{os.environ['PATH']}", "MANPAGER": "cat", "LC_ALL": "C.UTF-8"}
        self.names = set(re.findall(r"^  (\w+) ", self.ok("--help").stdout.partition("Subcommands:")[2], re.M))
        self.ran = 0
        self.configured = False  # the page's configuration holds, which names the card

    def shell(self, command):
        return subprocess.run(["sh", "-ec", command], input=ANSWERS if "--walk" in command else "", capture_output=True, text=True,
                              cwd=self.dir, env=self.env, timeout=4 * PATIENCE_S, check=False)

    def serve(self, document, command):
        """Runs a command without an end until it says where it listens."""
        process = subprocess.Popen(["sh", "-ec", "exec " + command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.dir,
                                   env=self.env | {"XDG_RUNTIME_DIR": str(self.dir)})
        wanted = {"http": "listening: http://", "osc": "listening: osc ", "bhaptics": "listening: ws://"}
        missing = {"listening: socket "} | {text for option, text in wanted.items() if f"--{option} " in command}
        while missing:
            line = process.stdout.readline()
            self.assertTrue(line, f"{document}: {command}: {process.stderr.read() if not line else ''}")
            missing = {text for text in missing if not line.startswith(text)}
        process.terminate()
        process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 0, command)

    def run_command(self, document, command):
        why = next((why for begin, why in NOT_RUN.items() if command.startswith(begin)), None)
        if why:
            self.counts["not run"] += 1
            print(f"not run: {command}   [{document}: {why}]")
            return
        self.assertTrue(command.startswith(RUN), f"{document}: {command}: neither among what is run nor among what is not")
        meant, reasons = command, []
        for pattern, other, reason in INSTEAD.get(document, ()):
            changed = re.sub(pattern, other, meant)
            reasons += [reason] * (changed != meant)
            meant = changed
        if "hw:CARD=Tactor" in meant or self.configured:
            reasons.append("the card is a null device")
        if " serve " in meant:
            self.serve(document, meant)
        else:
            told = self.shell(meant)
            self.assertEqual(told.returncode, 0, f"{document}: {command}\n{told.stdout[-300:]}{told.stderr}")
        self.counts["instead" if reasons else "run"] += 1
        self.ran += 1
        if reasons:
            print(f"run: {meant}   [{document}: {'; '.join(reasons)}]")

    def read_block(self, document, block):
        """Reads blocks of TOML and CSV as the tool does."""
        if block.kind == "csv":
            self.ok("plan", "-", stdin=block.text)
        if block.kind != "toml":
            return
        name = f"block-{block.line}.toml"
        self.write(name, block.text)
        if block.text.startswith("[experiment]"):
            self.ok("experiment", name, "--dry-run")
            self.write(re.search(r'^name = "(.+)"', block.text, re.M)[1] + ".toml", block.text)  # for the commands after it
        elif block.text.startswith("[[stroke]]") or block.text.startswith("[stroke]"):
            self.ok("plan", name)
        else:
            self.ok("plan", "park2016-1", "--fit", "--config", name)
        if "raspberry-pi" in document:
            self.env["TACTOR_CONFIG"] = str(self.dir / name)
            self.configured = True

    def follow(self, document, blocks):
        for name, source in FILES.get(document, {}).items():
            self.write(name, (ROOT / source).read_bytes())
        for block in blocks:
            with self.subTest(document=document, line=block.line):
                if block.kind == "name":
                    self.assertIn(block.text.split()[1], self.names | {"--version"}, f"{document} speaks of {block.text}")
                elif block.kind == "command":
                    self.run_command(document, block.text)
                else:
                    self.read_block(document, block)

    def test_commands_of_the_readme(self):
        self.follow("README.md", code_of_markdown((ROOT / "README.md").read_text(encoding="utf-8")))
        self.assertGreater(self.ran, 1)

    def test_guide(self):
        mine = {file.name for file in self.dir.iterdir()}
        for page in GUIDE:
            self.follow(f"man/guide/{page.name}", code_of_markdown(page.read_text(encoding="utf-8")))
            for made in self.dir.iterdir():  # no page needs what another has made
                if made.name not in mine:
                    shutil.rmtree(made) if made.is_dir() else made.unlink()
        self.assertGreater(self.ran, 30)

    def test_links_lead_somewhere_and_the_guide_to_each_of_its_pages(self):
        linked = set()
        for file in [*(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "NEWS.md", "tests/lanes/README.md")), *GUIDE]:
            for link in re.findall(r"\]\(([^)\s]+)", file.read_text(encoding="utf-8")):
                if not re.match(r"[a-z]+:", link):
                    path, _, heading = link.partition("#")
                    target = file.parent / path if path else file
                    self.assertTrue(target.exists(), f"{file.name}: {link}")
                    linked.add(target.resolve())
                    if heading:
                        self.assertIn(heading, list_anchors(target), f"{file.name}: {link}")
        self.assertEqual({page.name for page in GUIDE} - {file.name for file in linked}, set())

    def test_how_to_begins_with_a_list_of_its_recipes(self):
        page = ROOT / "man/guide/how-to.md"
        self.assertEqual(re.findall(r"^\* \[.*\]\(#(.*)\)$", page.read_text(encoding="utf-8"), re.M), list_anchors(page)[1:])

    def test_the_files_that_the_architecture_names_are_there(self):
        named = re.findall(r"`([\w/]+\.[ch]pp)`", (ROOT / "man/guide/architecture.md").read_text(encoding="utf-8"))
        self.assertGreater(len(named), 30)
        self.assertEqual([file for file in named if not (ROOT / "src" / file).exists()], [])

    def test_readme_fits_a_screen_or_two(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()), 140)

    def test_readmes_of_examples(self):
        for file in sorted((ROOT / "examples").rglob("README.md")):
            self.follow(file.relative_to(ROOT).as_posix(), code_of_markdown(file.read_text(encoding="utf-8")))

    def test_commands_of_man_pages(self):
        for page in sorted((ROOT / "man").glob("*.[1-8]")):
            self.env.pop("TACTOR_CONFIG", None)
            self.configured = False
            self.follow(f"man/{page.name}", code_of_man(page.read_text(encoding="utf-8")))
        self.assertGreater(self.ran, 16)

    def test_the_first_reply_of_the_protocol(self):
        page = (ROOT / "man/tactor-protocol.7").read_text(encoding="utf-8")
        stroke, total_s = re.search(r'"method":"play","params":\{"stroke":"([\w-]+)".*?"total_s":([\d.]+)', page, re.S).groups()
        self.assertEqual(float(total_s), self.plan(stroke)["total_s"])

    def test_commands_in_comments_of_examples(self):
        for folder in ("arrays", "strokes"):
            for file in (ROOT / "examples" / folder).iterdir():
                shutil.copy(file, self.dir)
        for file in sorted((ROOT / "examples").rglob("*.toml")):
            self.follow(file.relative_to(ROOT).as_posix(), code_of_script(file.read_text(encoding="utf-8")))
        self.assertGreaterEqual(self.ran, 5)

    def test_what_is_not_run_is_shown_somewhere(self):
        shown = [block.text for file in [ROOT / "README.md", *GUIDE, *(ROOT / "examples").rglob("README.md")]
                 for block in code_of_markdown(file.read_text(encoding="utf-8"))]
        shown += [block.text for page in (ROOT / "man").glob("*.[1-8]") for block in code_of_man(page.read_text(encoding="utf-8"))]
        self.assertEqual([begin for begin in NOT_RUN if not any(text.startswith(begin) for text in shown)], [])

    def test_examples_of_help_run(self):
        for name in sorted(self.names):
            examples = re.search(r"^Examples:\n((?:  .*\n)+)", self.ok(name, "--help").stdout, re.M)[1].splitlines()
            self.assertIn(len(examples), (2, 3), name)
            self.follow(f"tactor {name} --help", [Block("command", example.strip(), 0) for example in examples])
        self.assertGreaterEqual(self.ran, 25)

    def not_shown(self, page):
        """Returns lines of code that mdoc changes: it takes a lone point or comma in a macro's line for punctuation, and
        quotes for its syntax."""
        pages = [" ".join(subprocess.run([*command, page], capture_output=True, text=True, encoding="utf-8", check=True,
                                         env=self.env).stdout.replace("\u2010", "-").replace("\\\n", "\n").split())
                 for command in (["mandoc", "-Tutf8", "-Owidth=200"],
                                 ["groff", "-mdoc", "-t", "-Tutf8", "-rLL=200n", "-P-c", "-P-b", "-P-o", "-P-u"])]
        return [f"{page.name}:{b.line}: {b.text}" for b in code_of_man(page.read_text(encoding="utf-8"), sentences=False)
                if not all(" ".join(b.text.split()) in shown for shown in pages)]

    def test_a_page_shows_the_code_of_its_source(self):
        for page in sorted((ROOT / "man").glob("*.[1-8]")):
            self.assertEqual(self.not_shown(page), [])
        page = self.write("eaten.7", ".Dd November 20, 2026\n.Dt EATEN 7\n.Os\n.Sh NAME\n.Nm eaten\n.Nd by mdoc\n.Sh DESCRIPTION\n"
                                     ".Dl tactor plan \"M 0 0\"\n.Pp\n.Dl tactor plan \\(dqM 1 1\\(dq\n.Pp\n.Dl grep . /sys\n")
        self.assertEqual(self.not_shown(page), ['eaten.7:8: tactor plan "M 0 0"', "eaten.7:12: grep . /sys"])

    def test_a_command_that_is_on_no_list_is_refused(self):
        for command in ("frobnicate --all", "tactorize", "rm -rf x"):
            with self.assertRaisesRegex(AssertionError, "neither among what is run"):
                self.run_command("x", command)

    def test_code_is_found_in_text(self):
        found = [(b.kind, b.text, b.line) for b in code_of_markdown(
            "Run `tactor plan\nx.toml`, or `tactor play`:\n\n    tactor plan \"a  b\"   # says it\n    sudo x\n\nand\n\n    [a]\n")]
        self.assertEqual(found, [("command", "tactor plan x.toml", 1), ("name", "tactor play", 2),
                                 ("command", 'tactor plan "a  b"   # says it', 4), ("command", "sudo x", 5), ("toml", "[a]\n", 9)])
        found = [b.text for b in code_of_man(".Bd -literal\ntactor plan \"a  b\"   says it\n                  all\nsudo x\n.Ed\n")]
        self.assertEqual(found, ['tactor plan "a  b"', "sudo x"])


class OneName(ToolTest):
    """Holds one name and one number for each wire in all documents."""

    # I2C (identification and set-up of cards), I2S, and the lines of a card of eight channels.
    TAKEN = {0, 1, 2, 3, *range(18, 28)}

    def texts(self):
        files = [ROOT / "README.md", *GUIDE, *(ROOT / "man").glob("*.[1-8]"), *(ROOT / "udev").iterdir(),
                 *(f for f in (ROOT / "examples").rglob("*") if f.is_file() and f.suffix not in (".png", ".svg", ".wav"))]
        return {f.relative_to(ROOT).as_posix(): f.read_text(encoding="utf-8") for f in files}

    # Plays and walks on a card. What counts above thresholds comes after these were measured.
    ON_A_CARD = re.compile(r"tactor (?:play|check(?=.* --walk))\b(?!.* --sl )(?=.* -D hw:)")

    def test_the_first_play_on_a_card_is_at_minus_40_dbfs(self):
        pages = {page.name: [b.text for b in code_of_markdown(page.read_text(encoding="utf-8")) if b.kind == "command"]
                 for page in (ROOT / "README.md", *GUIDE)}
        pages |= {page.name: [b.text for b in code_of_man(page.read_text(encoding="utf-8")) if b.kind == "command"] for page in (ROOT / "man").glob("*.[1-8]")}
        pages |= {f"tactor {name} --help": self.ok(name, "--help").stdout.splitlines() for name in ("play", "check")}
        pages["quickstart"] = (ROOT / "examples/quickstart").read_text(encoding="utf-8").splitlines()
        first = {name: next((line for line in lines if self.ON_A_CARD.search(line.partition(" #")[0])), None) for name, lines in pages.items()}
        first = {name: line for name, line in first.items() if line}
        self.assertGreater(len(first), 8)
        self.assertEqual({name: line for name, line in first.items() if " --level-dbfs -40" not in line}, {})
        code = [block.text for block in code_of_markdown((ROOT / "README.md").read_text(encoding="utf-8")) if "hw:CARD" in block.text]
        self.assertEqual(sum(bool(re.search(r"level_dbfs ?= ?-40\b", text)) for text in code), 3)  # C++ twice, and Python

    def test_the_version_is_the_same_everywhere(self):
        version = re.search(r"version: '([\d.]+)'", (ROOT / "meson.build").read_text(encoding="utf-8"))[1]
        self.assertIn(f"\nversion: {version}\n", (ROOT / "CITATION.cff").read_text(encoding="utf-8"))
        self.assertEqual(self.ok("--version").stdout.split()[1], version)

    def test_the_card_of_the_array(self):
        found = collections.Counter()
        for name, text in self.texts().items():
            for card in re.findall(r"hw:CARD=(\w+)", text):
                # Noise for the ears comes from another card.
                self.assertIn(card, ("Tactor", "ID", "Phones"), name)
                found[card] += 1
        self.assertGreater(found["Tactor"], 10)

    def test_gpio_lines_are_the_same_everywhere_and_free(self):
        lines = collections.defaultdict(set)
        for text in self.texts().values():
            text = text.replace("\\(dq", '"')
            for purpose, offset in re.findall(r"^(line|out|in) = \{[^}]*\boffset = (\d+)", text, re.M):
                lines[purpose].add(int(offset))
            for offset in re.findall(r"^gpio=(\d+)=op", text, re.M):
                lines["line"].add(int(offset))
            for offset in re.findall(r'name = "GPIO(\d+)"', text):
                lines["line"].add(int(offset))
        self.assertEqual({k: len(v) for k, v in lines.items()}, {"line": 1, "out": 1, "in": 1}, lines)
        used = set.union(*lines.values())
        self.assertEqual(len(used), 3)
        self.assertEqual(used & self.TAKEN, set())
        buttons, codes = [], []
        for text in self.texts().values():
            buttons += map(int, re.findall(r"^dtoverlay=gpio-key,gpio=(\d+)", text, re.M))
            codes += [set(map(int, found.split(","))) for found in re.findall(r"\boffsets = \[([\d, ]+)\]", text)]
        self.assertEqual((len(set(buttons)), set(buttons) & (used | self.TAKEN)), (2, set()))
        # Codes take lines that are free beside a USB card.
        self.assertEqual([found for found in codes if found & (used | set(buttons)) or found - set(range(18, 28))], [])
        self.assertIn(8, map(len, codes))


if __name__ == "__main__":
    main()
