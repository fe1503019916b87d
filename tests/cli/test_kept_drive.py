# SPDX-License-Identifier: MIT
"""Drive time of a tactor counts on from one run of a user to the next on the same device. Windows last an hour: no machine
is so slow that time itself gives it back."""
import json
import signal
import subprocess
import time

from harness import ALSA_CONFIG, TOOL, ToolTest, main
from serving import Server

LIMITS = ("--max-drive-s", "0.5", "--drive-window-s", "3600")
STILL = ("--path", "M 0 0 L 0.001 0", "--algorithm", "continuous")  # one tactor, all the time


class KeptDrive(ToolTest):
    def setUp(self):
        super().setUp()
        self.runtime = self.dir / "run"
        self.runtime.mkdir(mode=0o700)
        self.env["XDG_RUNTIME_DIR"] = str(self.runtime)

    def cuts(self, *args, seconds=0.3, limits=LIMITS, stroke=STILL, **more):
        r = self.ok("play", *stroke, "--duration", seconds, *limits, "--format", "json", *args, **more)
        return json.loads(r.stdout)["counters"]["drives_cut"]

    def running(self, *args):
        p = subprocess.Popen([TOOL, "play", *args, "-D", "null"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL, cwd=self.dir, env=self.env)
        self.addCleanup(p.stdin.close)
        self.addCleanup(p.wait)
        self.addCleanup(p.kill)
        return p

    def kept(self):
        return sorted(self.runtime.rglob("drive-time-*"))

    def test_two_runs_count_together(self):
        self.assertEqual(self.cuts("-D", "null"), 0)
        self.assertEqual([f.name for f in self.kept()], ["drive-time-null"])
        self.assertEqual(self.kept()[0].parent.stat().st_mode & 0o777, 0o700)
        self.assertEqual(self.cuts("-D", "null", env={"XDG_RUNTIME_DIR": str(self.dir)}), 0)  # another user
        self.assertEqual(self.cuts("-D", "null"), 1)
        self.write("alsa.conf", ALSA_CONFIG + 'pcm."the/other" { type null }\n')
        self.assertEqual(self.cuts("-D", "the/other"), 0)
        self.assertEqual([f.name for f in self.kept()], ["drive-time-null", "drive-time-the%2Fother"])

    def test_nothing_is_written_where_nothing_is_driven(self):
        self.ok("plan", "park2016-1")
        self.ok("render", "park2016-1", "-o", "x.wav")
        self.ok("play", "--live", "-", "-D", "null")
        self.refused(3, "play", *STILL, "-D", "nowhere")
        self.refused(2, "play", *STILL, "--max-drive-s", "0", "-D", "null")
        self.assertEqual(self.kept(), [])

    def test_a_torn_file_counts_as_none(self):
        self.assertEqual(self.cuts("-D", "null"), 0)
        file = self.kept()[0]
        whole = file.read_bytes()
        for torn in (b"", whole[:-1], whole[:len(whole) // 2], b"\xff\x00" * 4096, b"tactor-drive-time 1\n5\nend\n",
                     whole.replace(b"\n000000000", b"\n-00000000", 1), whole.replace(b"\n000000000", b"\nnan", 1)):
            with self.subTest(torn[:80]):
                file.write_bytes(torn)
                self.assertEqual(self.cuts("-D", "null"), 0)
                self.assertNotEqual(file.read_bytes(), torn)

    def test_a_folder_of_others_is_not_used(self):
        folder = self.runtime / "tactor"
        folder.mkdir()
        folder.chmod(0o777)
        self.assertEqual([self.cuts("-D", "null") for _ in range(2)], [0, 0])
        self.assertEqual(self.kept(), [])
        folder.rmdir()
        folder.symlink_to(self.dir)
        self.assertEqual(self.cuts("-D", "null"), 0)
        self.assertEqual(self.kept(), [])

    def test_a_folder_in_place_of_the_file_is_left_and_strokes_are_played(self):
        self.assertEqual(self.cuts("-D", "null"), 0)
        file = self.kept()[0]
        file.unlink()
        file.mkdir()
        self.assertIn("played 0.100 s", self.ok("play", *STILL, "--duration", "0.1", "-D", "null").stdout)
        self.assertTrue(file.is_dir())

    def test_a_killed_run_counts_too(self):
        for stroke in ((*STILL, "--duration", "300"), ("--live", "-")):
            with self.subTest(stroke[0]):
                p = self.running(*stroke)
                p.stdin.write(b"0 0\n")
                p.stdin.flush()
                self.until(lambda: any(f.stat().st_size for f in self.kept()), p)
                p.kill()
                p.wait()
                # The half second that was counted beforehand alone is the limit.
                self.assertEqual(self.cuts("-D", "null", seconds=0.1), 1)
                self.kept()[0].unlink()

    def test_without_a_limit_the_time_of_driving_is_kept(self):
        self.assertEqual(self.cuts("-D", "null", seconds=1.0, limits=("--max-drive-s", "3600", "--drive-window-s", "10")), 0)
        self.assertEqual(self.cuts("-D", "null", seconds=0.1), 1)

    def test_runs_at_once_count_together_once_they_have_ended(self):
        second = ("--max-drive-s", "1", "--drive-window-s", "3600")
        other = self.running(*STILL, "--duration", "300", *second)
        self.until(self.kept, other)
        corner = ("--path", "M 40 40 L 40 39.999", "--algorithm", "continuous")
        # The other's time is not this one's, but for the half second that it may drive any tactor.
        self.assertEqual(self.cuts("-D", "null", seconds=0.4, stroke=corner, limits=second), 0)
        other.send_signal(signal.SIGINT)
        other.wait()
        self.assertEqual(self.cuts("-D", "null", seconds=0.7, stroke=corner, limits=second), 1)
        self.assertEqual(self.cuts("-D", "null", seconds=0.7, limits=second), 1)

    def test_a_service_that_reopens_the_device_knows_the_drive_time_of_others(self):
        s = Server(self, "--idle-stop", "0.1", config="[limits]\nmax_drive_s = 0.5\nwindow_s = 3600\n",
                   env={"XDG_RUNTIME_DIR": str(self.runtime)})
        client = s.client()
        self.ok("play", *STILL, "--duration", "0.1", "--socket", s.where["socket"])
        self.until(lambda: client.ok("status")["stream"]["state"] == "idle", s.process)
        self.assertEqual(self.cuts("-D", "null"), 0)
        self.ok("play", *STILL, "--duration", "0.2", "--socket", s.where["socket"])
        self.assertEqual(s.terminate()[0], 0)
        self.assertEqual(self.cuts("-D", "null", seconds=0.1), 1)

    def test_a_service_counts_earlier_runs_and_is_counted(self):
        self.assertEqual(self.cuts("-D", "null"), 0)
        s = Server(self, config="[limits]\nmax_drive_s = 0.5\nwindow_s = 3600\n", env={"XDG_RUNTIME_DIR": str(self.runtime)})
        self.ok("play", *STILL, "--duration", "0.3", "--socket", s.where["socket"])
        self.assertEqual(s.terminate()[0], 0)
        self.assertEqual(self.cuts("-D", "null", seconds=0.1), 1)  # it was cut there, and is not open again


if __name__ == "__main__":
    main()
