# SPDX-License-Identifier: MIT
"""Answers from an input device of the kernel: held, heard, lost."""
import errno
import fcntl
import os
import pathlib
import struct
import unittest

from rig import INSIDE, RigTest, until, wait_for

EV_SYN, EV_KEY = 0, 1
KEYS = {"1": 2, "2": 3, "kp1": 79, "kp2": 80, "up": 103, "enter": 28}
SET_EVBIT, SET_KEYBIT, SETUP, CREATE, DESTROY, SYSNAME = 0x40045564, 0x40045565, 0x405C5503, 0x5501, 0x5502, 0x8040552C


class Pad:
    """A keypad of the kernel's uinput."""

    def __init__(self, keys=KEYS.values()):
        self.fd = os.open("/dev/uinput", os.O_WRONLY | os.O_NONBLOCK)
        fcntl.ioctl(self.fd, SET_EVBIT, EV_KEY)
        for key in keys:
            fcntl.ioctl(self.fd, SET_KEYBIT, key)
        fcntl.ioctl(self.fd, SETUP, struct.pack("HHHH80sI", 3, 0x1209, 0x7AC7, 1, b"tactor test keypad", 0))
        fcntl.ioctl(self.fd, CREATE)
        name = fcntl.ioctl(self.fd, SYSNAME, b"\0" * 64).split(b"\0")[0].decode()
        folder = pathlib.Path("/sys/devices/virtual/input") / name
        self.device = "/dev/input/" + wait_for(lambda: next(folder.glob("event*"), None), "its device").name
        wait_for(lambda: os.path.exists(self.device), self.device)

    def press(self, name):
        for value in (1, 0):
            for event in ((EV_KEY, KEYS.get(name, name), value), (EV_SYN, 0, 0)):
                os.write(self.fd, struct.pack("llHHi", 0, 0, *event))

    def unplug(self):
        if self.fd is not None:
            fcntl.ioctl(self.fd, DESTROY)
            os.close(self.fd)
        self.fd = None


@unittest.skipIf(INSIDE, "the root of the other Debian has no /dev/input")
class Keypad(RigTest):
    def setUp(self):
        super().setUp()
        self.pad = Pad()
        self.addCleanup(self.pad.unplug)

    def calibrate(self, *args):
        return self.start("calibrate", "--array", self.grid(), "--participant", "P07", "-o", "me.toml", "--tactors", "0", "--interval", "0.05",
                          "--keypad", self.pad.device, *args)

    def held(self):
        """Returns whether a process has it exclusively."""
        fd = os.open(self.pad.device, os.O_RDONLY)
        try:
            fcntl.ioctl(fd, 0x40044590, 1)
        except OSError as e:
            return e.errno == errno.EBUSY
        finally:
            os.close(fd)
        return False

    def test_a_session_takes_keys_of_two_devices_exclusively(self):
        self.assertFalse(self.held())
        second = Pad(keys=[KEYS["enter"]])
        self.addCleanup(second.unplug)
        p = self.calibrate("--method", "adjustment", "--keypad", second.device)
        until(p, "Any key begins")
        wait_for(self.held, "the keypad is held")
        self.pad.press("kp1")
        other = os.open(self.pad.device, os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, other)
        for series in range(1, 7):
            until(p, f"series {series}")
            self.pad.press("up")
            second.press("enter")
        out, err = p.communicate(timeout=60)
        # Says how loud it may get, and that this guest keeps no drive time.
        said = [line for line in err.splitlines() if not line.startswith(("tactor: highest level: ", "tactor: warning: "))]
        self.assertEqual((p.returncode, said), (0, []), err)
        self.assertRaises(BlockingIOError, os.read, other, 24)
        self.assertFalse(self.held())

    def test_a_key_before_the_question_is_no_answer(self):
        p = self.calibrate()
        until(p, "Any key begins")
        self.pad.press("2")
        until(p, "interval 1")
        self.pad.press("2")
        until(p, "which? ")
        self.assertIsNone(p.poll())
        self.pad.press("1")
        until(p, "trial 2")
        self.assertIn("\t1\t", (self.dir / "me.tsv").read_text().splitlines()[1])

    def test_a_keypad_that_is_unplugged_ends_the_session_and_says_so(self):
        p = self.calibrate()
        until(p, "Any key begins")
        self.pad.press("1")
        until(p, "which? ")
        device = self.pad.device
        self.pad.unplug()
        self.assertEqual(p.wait(60), 1)
        said = p.stderr.read()
        self.assertIn(device, said)
        self.assertIn("--resume", said)

    def test_a_held_or_unsuitable_keypad_is_refused(self):
        fd = os.open(self.pad.device, os.O_RDONLY)
        self.addCleanup(os.close, fd)
        fcntl.ioctl(fd, 0x40044590, 1)
        p = self.calibrate()
        self.assertEqual(p.wait(60), 3)
        self.assertIn("end the program that uses the device", p.stderr.read())
        mouse = Pad(keys=[0x110])
        self.addCleanup(mouse.unplug)
        self.pad.device = mouse.device
        p = self.calibrate()
        self.assertEqual(p.wait(60), 2)
        self.assertIn("no key for an answer", p.stderr.read())
