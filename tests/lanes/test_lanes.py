# SPDX-License-Identifier: MIT
"""Checks the beginnings of each lane, so that none breaks between its runs: readable scripts, packages, inputs, names. Usage: test_lanes.py TOOL SOURCE_ROOT"""
import ast
import importlib.machinery
import importlib.util
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from harness import ROOT, TOOL, ToolTest, main  # noqa: E402

FUZZ = ROOT / "tests/fuzz"


def said(*command, **more):
    return subprocess.run(command, check=True, capture_output=True, text=True, stdin=subprocess.DEVNULL, **more).stdout


def scripts():
    """Returns the scripts of the source, by first line or name: (file, its text)."""
    for file in sorted(f for f in ROOT.rglob("*") if f.is_file() and not f.relative_to(ROOT).parts[0].startswith((".git", ".cache", "build"))):
        if file.suffix in ("", ".py", ".sh"):
            try:
                yield file, file.read_text(encoding="utf-8")
            except UnicodeDecodeError:
                pass


class Lanes(ToolTest):
    def test_options_are_read_before_anything_is_done(self):
        run = ROOT / "tests/run"
        self.assertIn("tests/run [--all", said(run, "--help"))
        for option, why in (("--hepl", "no such option: --hepl"), ("--all=nix", 'no lane "nix"')):
            r = subprocess.run([run, option], capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual((r.returncode, r.stdout), (2, ""))
            self.assertIn(why, r.stderr)

    def test_each_script_can_be_read(self):
        shells = [file for file, text in scripts() if re.match(r"#!/bin/sh|.*\n# shellcheck shell=sh", text)]
        pythons = [(file, text) for file, text in scripts() if file.suffix == ".py" or text.startswith("#!/usr/bin/env python3")]
        self.assertGreater(min(len(shells), len(pythons)), 30)
        for file in shells:
            said("sh", "-n", str(file))
        for file, text in pythons:
            ast.parse(text, str(file))

    def test_what_measures_time_finds_its_helpers(self):
        for file in ROOT.glob("tests/*/timed/test_*.py"):
            said(sys.executable, "-c", f"import {file.stem}", str(TOOL), str(ROOT), "examples", env=os.environ | {"PYTHONPATH": f"{ROOT}/tests/cli:{file.parent}"})

    def test_packages_and_scripts_that_lanes_name_are_there(self):
        purposes = set(re.findall(r"^(\S+): ", (ROOT / "tests/packages").read_text(encoding="utf-8"), re.M))
        for file in [*(ROOT / "tests/lanes").iterdir(), ROOT / "tests/run", ROOT / "examples/quickstart", ROOT / "tests/vm/run"]:
            if not file.is_file() or file.suffix:
                continue
            text = file.read_text(encoding="utf-8")
            for line in re.findall(r"tests/install-packages ((?:[a-z][\w-]*(?: |\b))+)", text):
                self.assertLessEqual(set(line.split()), purposes, file)
            for name in re.findall(r"(?<![\w/.$\"}-])tests/[\w/.-]*\w", "\n".join(x for x in text.splitlines() if not x.startswith("#"))):
                if not re.search(r"/(test|fuzz)(-|$)|/hw$", name):
                    self.assertTrue((ROOT / name).exists(), f"{file}: {name}")
        table = (ROOT / "tests/lanes/all").read_text(encoding="utf-8")
        for wanted in re.findall(r"^    lane \S+ \d+ (\S+)", table, re.M):
            self.assertLessEqual(set(wanted.split(",")) - {"-"}, purposes)

    def test_a_lane_without_its_package_says_why(self):
        for name in ("node", "npm"):
            self.write(f"bin/{name}", "#!/bin/sh\n").chmod(0o755)
        for status, why in ((124, "npm did not answer within 180 s"), (1, "npm refused p 1")):
            self.write("bin/timeout", f"#!/bin/sh\nexit {status}\n").chmod(0o755)
            ends = said("sh", "-euc", "lane=some; build=$1; . tests/lanes/say; . tests/lanes/from-npm; from_npm p 1", "sh", str(self.dir), cwd=ROOT,
                        env=os.environ | {"PATH": f"{self.dir}/bin:{os.environ['PATH']}", "XDG_CACHE_HOME": str(self.dir)})
            self.assertIn(f"SKIPPED: some: {why}", ends)
            self.assertTrue(ends.endswith("0 passed, 0 failed, 1 skipped\n"), ends)

    def test_fuzzers_have_targets_and_seeds(self):
        names = {f.stem for f in FUZZ.glob("*.cpp") if "LLVMFuzzerTestOneInput" in f.read_text(encoding="utf-8")}
        formats = re.search(r"foreach format : \[(.*)\]", (FUZZ / "meson.build").read_text(encoding="utf-8"))[1]
        names = names - {"stroke_file"} | {"stroke_" + f for f in re.findall(r"\w+", formats)}
        lane = (ROOT / "tests/lanes/fuzz").read_text(encoding="utf-8")
        self.assertEqual(set(re.search(r"set -- ([a-z_ ]+)$", lane, re.M)[1].split()), names)
        said(sys.executable, str(FUZZ / "seeds.py"), str(ROOT), str(self.dir / "seeds"))
        self.assertEqual({f.name for f in (self.dir / "seeds").iterdir()}, names - {"planner"})
        self.assertIn("左手".encode(), b"".join(f.read_bytes() for f in (self.dir / "seeds/config_toml").iterdir()))

    def test_files_of_awkward_folders_are_not_compiled_as_one(self):
        for name in ("a&b", "a'b", "a;b", "a^b", 'a"b', "a*b", "a<b", "a?b", "a|b", "a\\b"):
            (self.dir / name).mkdir()
            self.assertRegex(said(str(ROOT / "tests/jobs"), "build", cwd=self.dir / name), r"^[1-9]\d* off\n$")

    def test_a_folder_that_is_set_up_stays_as_it_is(self):
        (self.dir / "meson-private").mkdir()
        (self.dir / "build.ninja").touch()
        for kind in ("on", "off"):
            (self.dir / "meson-private/cmd_line.txt").write_text(f"[options]\nunity = {kind}\n", encoding="utf-8")
            self.assertRegex(said(str(ROOT / "tests/jobs"), str(self.dir)), rf"^[1-9]\d* {kind}\n$")

    def test_quickstart_runs_by_a_link_twice_and_after_another(self):
        top = self.dir / "it's & mine"
        for file in ("examples/quickstart", "tests/install-packages", "tests/jobs", "tests/packages"):
            (top / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / file, top / file)
        tool = "mkdir -p build/src/cli && printf '#!/bin/sh\\necho played\\n' >build/src/cli/tactor && chmod +x build/src/cli/tactor"
        for name, text in (("dpkg-query", "echo installed"), ("meson", "touch build/build.ninja"),
                           ("ninja", f"case $* in *' -n '*) [ ! -e build/src ] || echo 'ninja: no work to do.' ;; *) {tool} ;; esac")):
            self.write(f"bin/{name}", f"#!/bin/sh\n{text}\n").chmod(0o755)
        (self.dir / "other/examples").mkdir(parents=True)
        (self.dir / "quickstart").symlink_to(top / "examples/quickstart")
        self.env |= {"PATH": f"{self.dir}/bin:{os.environ['PATH']}", "CDPATH": str(self.dir / "other")}
        start = {"args": ["./quickstart"], "cwd": self.dir, "env": self.env, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        first, second = (subprocess.run(check=True, **start).stdout for _ in range(2))
        self.assertIn(" minutes on a PC", first)
        self.assertIn("\nplayed\n", first)
        self.assertNotIn(" minutes on a PC", second)
        with open(top / "build/quickstart.lock", "a", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            waiting = subprocess.Popen(**start)
            self.assertEqual(waiting.stdout.readline(), "Waits until another quickstart has built this folder.\n")
        self.assertIn("\nplayed\n", waiting.communicate()[0])
        shutil.rmtree(top / "build")
        (top / "build").touch()  # as where the source cannot be written
        self.assertEqual(subprocess.run(check=False, **start).stdout,
                         f"quickstart: {top}/build cannot be written (copy the source to a folder of your own)\n")

    def test_a_change_that_hangs_a_test_leaves_nothing_running(self):
        loader = importlib.machinery.SourceFileLoader("mutate", str(ROOT / "tests/mutate"))
        mutate = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutate", loader))
        loader.exec_module(mutate)
        self.write("hangs", "#!/bin/sh\n# As Meson starts a test: in a session of its own.\n"
                   "setsid sh -c 'echo $$ >pid; mv pid began; exec sleep 10000' & wait\n").chmod(0o755)
        patience_s = 1
        while not (self.dir / "began").exists():
            self.assertIsNone(mutate.run([str(self.dir / "hangs")], self.dir, patience_s))
            patience_s *= 2
        stat = pathlib.Path("/proc") / (self.dir / "began").read_text(encoding="utf-8").strip() / "stat"
        self.assertTrue(not stat.exists() or stat.read_text(encoding="utf-8").rpartition(")")[2].split()[0] in "ZX")


if __name__ == "__main__":
    main()
