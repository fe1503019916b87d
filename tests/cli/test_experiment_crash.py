# SPDX-License-Identifier: MIT
"""A simulated session that is killed at any of its writes, or whose disk is full at any of them, resumes as if nothing had
happened: strace injects the signal and the error."""
import shutil
import subprocess
import unittest

from experiments import SMALL, ExperimentTest, contents
from harness import TOOL, main

# System calls that change a disk. strace counts each separately. (A kill at an fsync leaves the same as a kill at the next of
# these.)
CALLS = ("write", "rename", "mkdir", "unlink", "ftruncate")


def traceable():
    if shutil.which("strace") is None:
        return "strace is not here"
    probe = subprocess.run(["strace", "-f", "-o", "/dev/null", "-e", "inject=chdir:error=EIO:when=1", "true"],
                           capture_output=True, text=True, check=False)
    return "" if probe.returncode == 0 else f"ptrace is not permitted: {probe.stderr.strip().splitlines()[-1:]}"


WHY_NOT = traceable()


@unittest.skipIf(WHY_NOT, WHY_NOT)
class AtEveryWrite(ExperimentTest):
    def setUp(self):
        super().setUp()
        # Two runs, void trials, practice: each kind of write, but few of them.
        self.small(SMALL.replace("trials = 4", "trials = 2").replace("trials = 3", "trials = 2"))
        self.args = ["experiment", "small.toml", "--participant", "01", "-o", "study", "--simulate",
                     "seed=4,sigma=1,void=0.3"]
        self.ok(*self.args)
        self.whole = contents(self.dir / "study")

    def strace(self, call, fault, n, *more, resume=()):
        """Runs the tool with the n-th call failing."""
        return subprocess.run(["strace", "-f", "-qq", "-o", self.dir / "trace", *more, "-e", f"trace={call}", "-e", f"inject={call}:{fault}:when={n}",
                               TOOL, *self.args, *resume], cwd=self.dir, env=self.env, capture_output=True, text=True, check=False)

    def with_fault(self, call, fault, n):
        """Runs a session from its begin with the n-th call failing."""
        shutil.rmtree(self.dir / "study", ignore_errors=True)
        if (self.dir / "before").exists():
            shutil.copytree(self.dir / "before", self.dir / "study")
        return self.strace(call, fault, n)

    def resumed(self, said):
        sessions = [sum(name.endswith("/session.json") for name in files) for files in (self.whole, contents(self.dir / "study"))]
        self.ok(*self.args, *(["--resume"] if sessions[0] == sessions[1] else []))
        self.assertEqual(contents(self.dir / "study"), self.whole, said)

    def test_kill_9_loses_nothing(self):
        self.kill_at_each(CALLS)

    def test_kill_9_in_a_second_session_loses_nothing(self):
        self.edit("small.toml", "gap_s", "sessions = 2\ngap_s")
        shutil.rmtree(self.dir / "study")
        self.ok(*self.args, "--session", "1")
        shutil.copytree(self.dir / "study", self.dir / "before")
        self.args += ["--session", "2"]
        self.ok(*self.args)
        self.whole = contents(self.dir / "study")
        self.kill_at_each(("rename", "mkdir"))

    def kill_at_each(self, calls):
        for call in calls:
            n = 0
            while True:
                n += 1
                run = self.with_fault(call, "signal=KILL", n)
                if run.returncode == 0:
                    break
                self.assertEqual(run.returncode, -9, f"{call} {n}: {run.stderr}")
                self.resumed(f"killed at {call} {n}")
            print(f"{call}: killed {n - 1} times")
            if call in ("write", "rename"):
                self.assertGreater(n, 15, call)

    def test_a_full_disk_loses_nothing(self):
        refused = kept = 0
        for call, fault in (("write", "error=ENOSPC"), ("rename", "error=EDQUOT")):
            self.with_fault(call, fault, 65535)
            calls = len((self.dir / "trace").read_text().splitlines())
            self.assertGreater(calls, 15)
            for n in range(1, calls + 1):
                run = self.with_fault(call, fault, n)
                if run.returncode == 0:
                    continue  # not a file: a wake-up, a line on standard output that is retried
                refused += 1
                self.assertEqual(run.returncode, 1, f"{call} {n}: {run.stderr}")
                self.assertRegex(run.stderr, r"No space left|quota exceeded", f"{call} {n}")
                # The reserved space takes the answer, and the session stops.
                kept += "earlier answers are kept" in run.stderr
                self.resumed(f"{call} {n} failed")
        self.assertGreater(refused, 30)
        self.assertGreater(kept, 10)

    def test_a_disk_that_fails_while_a_line_is_cut_off(self):
        table = next((self.dir / "study/sub-01/beh").glob("*howgood*"))
        text = table.read_bytes()[:-20]
        order = [line.split("\t")[0] for line in (self.dir / "study/sub-01/sub-01_scans.tsv").read_text().splitlines()[1:]]
        for name in order[order.index(f"beh/{table.name}") + 1:]:
            (self.dir / "study/sub-01" / name).unlink()
        table.write_bytes(text)
        for call in ("ftruncate", "fsync"):
            run = self.strace(call, "error=EIO", 1, "-P", table, resume=["--resume"])
            self.assertEqual(run.returncode, 1, f"{call}: {run.stderr}")
            self.assertIn(f"{table.name}: Input/output error (earlier answers are kept", run.stderr)
            self.assertEqual(table.with_name(table.name + ".cut-1").read_bytes(), text.rpartition(b"\n")[2])
            if call == "ftruncate":
                self.assertEqual(table.read_bytes(), text)
        self.ok(*self.args, "--resume")
        self.assertEqual(contents(self.dir / "study")[str(table.relative_to(self.dir / "study"))],
                         self.whole[str(table.relative_to(self.dir / "study"))])


if __name__ == "__main__":
    main()
