# SPDX-License-Identifier: MIT
"""The amplifier's line through every end of a player, when it is taken away, and when nobody is left to switch it off."""
import fcntl
import os
import pathlib
import signal
import struct
import subprocess
import time

from rig import BUILD, ENTER, TOOL, AmplifierTest, wait_for

MAY_BE_ON = "tactor: amplifier: its line cannot be switched off"


class Amplifier(AmplifierTest):
    def test_it_is_on_while_a_stroke_plays_and_off_before_and_after(self):
        self.assertFalse(self.on())
        p = self.playing("1", strokes=1)
        seen = []
        while p.poll() is None:
            seen.append(self.on())
            time.sleep(0.005)
        self.assertEqual(p.returncode, 0, p.stderr.read())
        self.assertTrue(any(seen))
        # On once, off once.
        self.assertEqual(sum(a != b for a, b in zip(seen, seen[1:])), 1, seen)
        self.assertFalse(self.on())

    def test_ctrl_c_and_sigterm_switch_it_off(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            p = self.playing()
            p.send_signal(number)
            # The fade and the silence behind it come first: 16 periods of 240 frames are queued.
            self.off_within(signal.Signals(number).name, self.LIMIT_S + 0.12)
            self.assertEqual(p.wait(20), status)

    def test_sigkill_switches_it_off_at_any_moment(self):
        for delay in (0.0, 0.05, 0.3):
            p = self.playing()
            time.sleep(delay)
            p.kill()
            self.off_within("SIGKILL")
            p.wait(20)

    def test_sigstop_switches_it_off_and_sigcont_lets_the_player_end_well(self):
        p = self.playing()
        os.kill(p.pid, signal.SIGSTOP)
        self.off_within("SIGSTOP")
        os.kill(p.pid, signal.SIGCONT)
        p.send_signal(signal.SIGINT)
        p.wait(20)
        self.assertFalse(self.on())

    def test_a_busy_line_names_its_holder(self):
        first = self.playing()
        second = self.tool("play", "park2016-1", "--array", self.array, "-D", "null")
        self.assertEqual(second.returncode, 3, second.stderr)
        self.assertIn("tactor", second.stderr.split(":", 2)[2])
        first.send_signal(signal.SIGINT)
        first.wait(20)

    def test_play_killed_at_its_system_calls_leaves_the_amplifier_off(self):
        """Runs tests/cli/test_killed.cpp with the amplifier on the simulated chip."""
        env = self.env | {"TACTOR_TOOL": str(TOOL), "TACTOR_ARRAY": str(self.array),
                          "TACTOR_LINE": str(self.gpio.sysfs / f"sim_gpio{self.LINE}/value")}
        r = subprocess.run([*ENTER, BUILD / "tests/cli/test-killed", "--no-colors=true"], capture_output=True, text=True,
                           timeout=400, check=False, cwd=self.dir, env=env)
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        self.assertNotIn("SKIPPED", r.stdout)
        print(*(line for line in r.stdout.splitlines() if line.startswith("play killed at")), sep="\n")


def holders():
    """Returns the processes that hold an amplifier's line for a player."""
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            if pathlib.Path("/proc", process, "comm").read_text() == "tactor-amp\n":
                found.append(int(process))
        except OSError:
            pass  # it has just ended
    return found


def stands_still(pid):
    tasks = pathlib.Path(f"/proc/{pid}/task").iterdir()
    return all((t / "stat").read_text().rpartition(")")[2].split()[0] == "T" for t in tasks)


class OtherProgram:
    """Holds a line as an output that is on, through the kernel's own interface (linux/gpio.h, version 2)."""
    GET_LINE = 3 << 30 | 592 << 16 | 0xB4 << 8 | 0x07
    OUTPUT, OUTPUT_VALUES = 1 << 3, 2

    def __init__(self, chip, line):
        attribute = struct.pack("=IIQQ", self.OUTPUT_VALUES, 0, 1, 1)
        config = struct.pack("=QI20x", self.OUTPUT, 1) + attribute.ljust(240, b"\0")
        offsets = struct.pack("=I", line).ljust(256, b"\0")
        request = bytearray(offsets + b"someone else".ljust(32, b"\0") + config + struct.pack("=II20xi", 1, 0, 0))
        fd = os.open(f"/dev/{chip}", os.O_RDWR)
        fcntl.ioctl(fd, self.GET_LINE, request)
        os.close(fd)
        self.fd = struct.unpack_from("=i", request, 588)[0]

    def close(self):
        os.close(self.fd)


class LineLost(AmplifierTest):
    def ended(self, p, status):
        _, err = p.communicate(timeout=60)
        print(err)
        self.assertEqual(p.returncode, status, err)
        return err

    def find_holder(self):
        # A listing of /proc may miss one while others come and go.
        found = wait_for(holders, "a holder is there")
        self.assertEqual(len(found), 1, found)
        return found[0]

    def test_a_chip_removed_while_the_line_is_on_is_an_error_that_says_so(self):
        p = self.playing()
        self.gpio.close()
        p.send_signal(signal.SIGINT)
        self.assertIn(MAY_BE_ON, self.ended(p, 3))
        wait_for(lambda: not holders(), "the holder ends")
        r = self.tool("off", "--array", self.array)
        self.assertEqual(r.returncode, 3, r.stderr)
        self.assertIn(self.gpio.label, r.stderr)

    def test_a_line_taken_by_another_program_after_the_holder_s_death_is_left_to_it_and_reported_on(self):
        p = self.playing()
        holder = self.find_holder()
        os.kill(p.pid, signal.SIGSTOP)  # or it would be faster
        wait_for(lambda: stands_still(p.pid), "all threads of the player are stopped")
        os.kill(holder, signal.SIGKILL)
        wait_for(lambda: not holders(), "the holder is gone")
        other = OtherProgram(self.gpio.chip, self.LINE)
        self.addCleanup(lambda: other.fd >= 0 and other.close())
        os.kill(p.pid, signal.SIGCONT)
        self.assertIn(MAY_BE_ON, self.ended(p, 3))
        self.assertTrue(self.on())
        r = self.tool("off", "--array", self.array)
        self.assertEqual(r.returncode, 3, r.stderr)
        self.assertIn("someone else", r.stderr)
        self.assertTrue(self.on())
        other.close()
        other.fd = -1
        r = self.tool("off", "--array", self.array)
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        self.assertEqual(r.stdout, f"amplifier: line {self.LINE} of {self.gpio.label} (/dev/{self.gpio.chip}) is off\n")
        self.assertFalse(self.on())

    def test_a_stopped_holder_loses_the_line_to_the_player(self):
        p = self.playing()
        os.kill(self.find_holder(), signal.SIGSTOP)
        # Ten beats, each 40 ms and the emulated machine's lateness, are not answered.
        self.off_within("SIGSTOP of the holder", 1.5)
        self.assertIn("the amplifier was off", self.ended(p, 1))
        self.assertEqual(holders(), [])
        self.assertFalse(self.on())

    def test_a_killed_holder_loses_the_line_to_the_player(self):
        p = self.playing()
        os.kill(self.find_holder(), signal.SIGKILL)
        self.off_within("SIGKILL of the holder")
        self.assertIn("the amplifier was off", self.ended(p, 1))

    def test_off_waits_for_the_holder_of_a_player_that_was_killed(self):
        p = self.playing()
        p.kill()
        r = self.tool("off", "--array", self.array)
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertFalse(self.on())
        p.wait(20)

    def test_both_killed_the_line_is_as_the_chip_leaves_it(self):
        # Floating, this line is high: a stand-in for chips that keep their last state.
        p = self.playing()
        self.gpio.pull(self.LINE, True)
        holder = self.find_holder()
        os.kill(p.pid, signal.SIGKILL)
        os.kill(holder, signal.SIGKILL)
        p.wait(20)
        wait_for(lambda: not holders(), "the holder is gone")
        print(f"player and holder killed together: the line is {'on' if self.on() else 'off'}, the stated exception")
        self.gpio.pull(self.LINE, False)
        r = self.tool("off", "--array", self.array)
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertFalse(self.on())
