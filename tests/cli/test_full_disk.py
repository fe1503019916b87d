# SPDX-License-Identifier: MIT
"""Disks that become full or read-only: no file is replaced by half of another, no answer is lost or doubled, and a hint says
what to do."""
import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from experiments import DESK, SHORT, SMALL, ExperimentTest, Terminal
from harness import ALSA_CONFIG, FELT_CONFIG, PATIENCE_S, TOOL, main
from serving import Server

PAGE = 4096  # a tmpfs gives space in pages
CLONE_NEWNS, MS_REC, MS_PRIVATE = 0x20000, 0x4000, 0x40000


def run(*command):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)


def why_not():
    """Returns the reason why there can be none; empty where there can. Later mounts belong to this process and end with it,
    even if it is killed."""
    if os.geteuid() != 0 or shutil.which("mount") is None:
        return "a disk of a test's own takes root, and mount"
    libc = ctypes.CDLL(None)
    if libc.unshare(CLONE_NEWNS) == 0:
        libc.mount(None, b"/", None, ctypes.c_ulong(MS_REC | MS_PRIVATE), None)
    with tempfile.TemporaryDirectory() as folder:
        tried = run("mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder)
        run("umount", "-l", folder)
    return "" if tried.returncode == 0 else f"mount is refused: {tried.stderr.strip()}"


class Disk:
    """A small disk at the folder `disk` of the test, which can be full or read-only for real; unmounted when the test ends."""

    def __init__(self, test, kib=1024, files=200):
        self.path = pathlib.Path(test.dir) / "disk"
        self.path.mkdir()
        test.addCleanup(run, "umount", "-l", self.path)
        made = run("mount", "-t", "tmpfs", "-o", f"size={kib}k,nr_inodes={files}", "tmpfs", self.path)
        assert made.returncode == 0, made.stderr

    def left(self):
        return os.statvfs(self.path).f_bavail * PAGE

    def fill(self, pages=0):
        """Fills the disk until so many bytes are left."""
        with open(self.path / "filler", "ab", buffering=0) as f:
            f.write(bytes(self.left() - pages * PAGE))
        assert self.left() == pages * PAGE, self.left()

    def fill_names(self, left=0):
        """Makes files until so many more can be made."""
        there = len(list(self.path.glob("filler*")))
        for i in range(os.statvfs(self.path).f_ffree - left):
            (self.path / f"filler{there + i}").touch()
        assert os.statvfs(self.path).f_ffree == left

    def make_room(self):
        for file in self.path.glob("filler*"):
            file.unlink()

    def read_only(self, yes=True):
        done = run("mount", "-o", f"remount,{'ro' if yes else 'rw'}", self.path)
        assert done.returncode == 0, done.stderr

    def files(self):
        """Returns names and bytes, except of the filler and of the date, which may change meanwhile."""
        return {str(p.relative_to(self.path)): re.sub(rb'(?m)^( *"date": |date = )"\d{4}-\d\d-\d\d"', b"", p.read_bytes()) for p in sorted(self.path.rglob("*"))
                if p.is_file() and not p.name.startswith("filler")}


WHY_NOT = why_not()
NO_SPACE = "No space left on device"
FREE_SOME = "free some space"


@unittest.skipIf(WHY_NOT, WHY_NOT)
class FullDisk(ExperimentTest):
    def redirected(self, *args):
        """Runs the tool with standard output on the disk; returns its messages."""
        with open(self.dir / "disk/out", "wb") as out:
            r = subprocess.run([TOOL, *args], cwd=self.dir, env=self.env, stdout=out, stderr=subprocess.PIPE, text=True,
                               timeout=PATIENCE_S, check=False)
        self.assertEqual(r.returncode, 1, r.stderr)
        (self.dir / "disk/out").unlink()
        return r.stderr

    def test_a_file_is_written_whole_or_not_at_all(self):
        disk = Disk(self, 8192)
        self.simulate()
        for args in (("render", "park2016-1", "-o", "disk/o.wav"),
                     *(("plot", "park2016-1", "-o", f"disk/o.{e}") for e in ("svg", "pdf", "png")),
                     ("compare", "park2016-1", "-o", "disk/c.svg"), ("report", "study", "-o", "disk/o.md"),
                     ("analyze", "study", "-o", "disk/a.svg")):
            for _ in range(2):  # without and with a file there
                kept = disk.files()
                for fill in (disk.fill, lambda: disk.fill(1), disk.fill_names):
                    fill()
                    r = self.run_tool(*args)
                    self.assertEqual((r.returncode, r.stderr), (1, f"tactor: {args[-1]}: it cannot be written: {NO_SPACE} ({FREE_SOME}, "
                                                                   "or name a file on another disk; nothing was left behind)\n"))
                    self.assertEqual(disk.files(), kept, args)
                    disk.make_room()
                self.ok(*args)
                self.assertGreater(len(disk.files()[args[-1].removeprefix("disk/")]), PAGE)

    def test_standard_output_to_a_full_disk_is_an_error(self):
        disk = Disk(self)
        long = ("plan", "--path", "M 0 0 L 40 40", "--duration", "300", "--format")
        for args in ((*long, "json"), (*long, "csv"), ("plan", "park2016-1", "--format", "json"), ("render", "park2016-1", "-o", "-"),
                     ("experiment", "park2016", "--dry-run", "--format", "json")):
            for pages in (0, 1):
                disk.fill(pages)
                said = self.redirected(*args)
                self.assertRegex(said, rf"(standard output|/dev/stdout: it cannot be written): {NO_SPACE} \({FREE_SOME}, .* is incomplete\)")
                disk.make_room()

    def test_a_read_only_disk_is_an_error(self):
        disk = Disk(self, 8192)
        self.ok("render", "park2016-1", "-o", "disk/o.wav")
        kept = disk.files()
        disk.read_only()
        for name in ("o.wav", "p.wav"):
            self.refused(1, "render", "park2016-2", "-o", f"disk/{name}")
        disk.read_only(False)
        self.assertEqual(disk.files(), kept)

    def test_drive_time_that_cannot_be_kept_is_said_at_play_and_found_by_check(self):
        self.write("alsa.conf", ALSA_CONFIG + FELT_CONFIG)
        disk = Disk(self)
        disk.path.chmod(0o700)
        self.env["XDG_RUNTIME_DIR"] = str(disk.path)
        play = ("play", "park2016-1", "-D", "felt")

        def warnings():
            return [line for line in self.ok(*play).stderr.splitlines() if "drive-time" in line]
        self.assertEqual(warnings(), [])
        kept = disk.files()
        (disk.path / "tactor/drive-time-felt").unlink()
        for fail, mend, why in ((disk.fill, disk.make_room, NO_SPACE), (disk.fill_names, disk.make_room, NO_SPACE),
                                (disk.read_only, lambda: disk.read_only(False), "Read-only file system")):
            with self.subTest(why=why):
                fail()
                file = disk.path / "tactor/drive-time-felt"
                self.assertEqual(warnings(), [f"tactor: warning: {file} cannot be written: {why}: the next run will not know for how long the array "
                                              "was driven"])
                self.assertRegex(self.ok("check", "-D", "felt").stdout, rf"(?m)^warning +drive time +[^\0]*{why.split()[0]}")
                mend()
                self.assertEqual(disk.files(), {})
        self.assertEqual(warnings(), [])
        self.assertEqual(disk.files().keys(), kept.keys())
        # Counts what is there, though it cannot be written.
        file = disk.path / "tactor/drive-time-felt"
        file.write_text(re.sub(r"(?m)^level .*", "level 5.0", file.read_text()))
        disk.read_only()
        self.assertRegex("".join(warnings()), "cannot be written: Read-only file system")
        self.assertRegex(self.ok("check", "-D", "felt").stdout, r"(?m)^warning +drive time ")

    def test_calibrate_loses_no_answer(self):
        args = ("calibrate", "--participant", "P07", "-o", "disk/me.toml", "--simulate", "threshold=-45,spread=2",
                "--reversals", 8, "--tactors", "0-2")
        disk = Disk(self)
        self.ok(*args)
        whole = disk.files()
        begun = kept = pages = 0
        while True:
            for name in whole:
                (disk.path / name).unlink()
            disk.fill(pages)
            r = self.run_tool(*args)
            if r.returncode == 0:
                break
            log = disk.files().get("me.tsv", b"")  # missing without answers
            self.assertEqual(r.returncode, 1, r.stderr)
            self.assertTrue(whole["me.tsv"].startswith(log))
            self.assertNotIn("me.toml", disk.files())
            # Before it begins, when a trial is answered, and when all are.
            begun += "me.json: it cannot be written" in r.stderr
            if "me.json" not in r.stderr:
                self.assertRegex(r.stderr, rf"me\.(tsv|toml): {NO_SPACE} \(earlier answers are kept; free some space, and continue with --resume\)")
                kept += len(log.splitlines()) > 2
            resume = ["--resume"] if "me.tsv" in disk.files() else []
            self.refused(1, *args, *resume, says=[NO_SPACE])  # there still is no space
            disk.make_room()
            self.ok(*args, *resume)
            self.assertEqual(disk.files(), whole, pages)
            pages += 1
        self.assertEqual(disk.files(), whole)
        self.assertEqual((begun, kept), (1, pages - 2))
        self.assertGreater(kept, 1)

    def study(self, fill):
        """Simulates a session for each amount of space, and counts how often an answer took the reserved space."""
        self.small(SMALL.replace("trials = 4", "trials = 40"))
        args = ("experiment", "small.toml", "--participant", "01", "-o", "disk/study", "--simulate", "seed=4,sigma=1,void=0.3")
        disk = Disk(self)
        self.ok(*args)
        whole = disk.files()

        def answered():
            return {n: d for n, d in disk.files().items() if n.endswith("_beh.tsv")}

        kept = left = 0
        while True:
            shutil.rmtree(disk.path / "study")
            fill(disk, left)
            r = self.run_tool(*args)
            if r.returncode == 0:
                break
            self.assertEqual(r.returncode, 1, r.stderr)
            # A first file may be written elsewhere.
            self.assertRegex(r.stderr, rf"{NO_SPACE} \(.*(free some space.*)\)")
            kept += "earlier answers are kept" in r.stderr
            found = answered()
            for name, data in found.items():
                self.assertTrue(whole[name].startswith(data) and data.endswith(b"\n"), name)
            if found:
                fill(disk, 0)  # of the space reserved for an answer
                self.refused(1, *args, "--resume", says=[NO_SPACE])
                self.assertEqual(answered(), found)
            disk.make_room()
            begun = (disk.path / "study/sourcedata/sub-01/session.json").exists()
            self.ok(*args, *(["--resume"] if begun else []))
            self.assertEqual(disk.files(), whole, left)
            left += 1
        self.assertEqual(disk.files(), whole)
        return kept

    def test_a_simulated_study_on_a_full_disk_resumes(self):
        self.assertGreater(self.study(Disk.fill), 2)

    def test_a_simulated_study_on_a_disk_without_names_resumes(self):
        self.assertGreater(self.study(Disk.fill_names), 5)

    def person(self, *more):
        self.write("desk.toml", DESK)
        self.write("short.toml", SHORT)
        t = Terminal(self, ("experiment", "short.toml", "--participant", "01", "-o", "disk/study", "-D", "null", *more))
        return t

    def asked(self, answered):
        """Begins a session on a disk, and answers some questions; returns the disk, and the terminal with the next one."""
        disk, t = Disk(self), self.person()
        t.begin()
        for _ in range(answered):
            t.answer("Which one\\? ", "1")
        t.until("Which one\\? ")
        return disk, t

    def answers(self, run):
        return [r["rating" if run == "marks" else "response"] for r in self.rows("01", run, "disk/study")]

    def resumed(self, *answers):
        """Resumes a session with these answers to their questions."""
        t = self.person("--resume")
        t.walk(agrees=False)
        for question, answer in answers:
            t.answer(question, answer)
        self.assertEqual(t.end(), 0, t.said())

    def test_a_disk_that_fills_while_somebody_answers(self):
        disk, t = self.asked(2)  # practice, and a trial
        disk.fill()
        t.key("2")  # there is space where the table ends
        t.answer("Any key begins", " ")
        t.answer("How even\\? ", "3")  # this takes another table
        self.assertEqual(t.end(), 1)
        self.assertRegex(t.said(), rf"{NO_SPACE} \(earlier answers are kept; free some space, and continue with --resume\)")
        self.assertEqual((self.answers("pairs"), self.answers("marks")), (["1", "2"], ["3"]))
        disk.make_room()
        self.resumed(("Any key begins", " "), ("Trial 2/2: How even\\? ", "1"), ("Any key ends", " "))
        self.assertEqual((self.answers("pairs"), self.answers("marks")), (["1", "2"], ["3", "1"]))

    def test_a_disk_without_names_while_somebody_answers(self):
        disk, t = self.asked(1)
        disk.fill_names()
        t.key("2")
        self.assertEqual(t.end(), 1)
        self.assertRegex(t.said(), rf"{NO_SPACE} \(earlier answers are kept; free some space, and continue with --resume\)")
        self.assertEqual(self.answers("pairs"), ["2"])

    def test_a_disk_that_becomes_read_only_while_somebody_answers(self):
        disk, t = self.asked(2)
        disk.read_only()
        t.key("2")
        self.assertEqual(t.end(), 1)
        self.assertRegex(t.said(), r"Read-only file system \(earlier answers are kept; make the disk writable again, and continue with --resume\)")
        t = self.person("--resume")
        self.assertEqual(t.end(), 1)
        self.assertIn("Read-only file system", t.said())
        disk.read_only(False)
        self.assertEqual(self.answers("pairs"), ["1"])
        self.resumed(("Any key begins", " "), ("Trial 2/2: [^?]*Which one\\? ", "2"), ("Any key begins", " "),
                     ("How even\\? ", "3"), ("How even\\? ", "1"), ("Any key ends", " "))
        self.assertEqual((self.answers("pairs"), self.answers("marks")), (["1", "2"], ["3", "1"]))

    def test_serve_goes_on_without_its_log(self):
        disk = Disk(self)
        log = disk.path / "serve.log"
        line = "2026-01-01T00:00:00.000Z info an earlier line\n"
        # The next page begins in the first line that it writes.
        log.write_text(line * (PAGE // len(line) + 1))
        log.write_bytes(log.read_bytes()[:PAGE - 10 - len(line)] + b"\n" + line.encode())
        before = log.read_text()
        disk.fill()
        s = Server(self, "--log", log)
        c = s.client()
        self.assertEqual(c.await_end(c.ok("play", stroke="park2016-1")["stroke"])["state"], "finished")
        disk.make_room()
        self.assertEqual(c.await_end(c.ok("play", stroke="park2016-1")["stroke"])["state"], "finished")
        status, _, err = s.terminate()
        self.assertEqual(status, 0, err)
        self.assertEqual(err.count(f"serve.log: {NO_SPACE}: the log ends here"), 1)
        self.assertEqual(log.read_text(), before)
        # The next server begins a new line.
        s = Server(self, "--log", log)
        self.assertEqual(s.terminate()[0], 0)
        lines = log.read_text().removeprefix(before).splitlines()
        self.assertGreater(len(lines), 2)
        for each in lines:
            self.assertRegex(each, r"^\d{4}-\d\d-\d\dT[\d:.]+Z info ")


if __name__ == "__main__":
    main()
