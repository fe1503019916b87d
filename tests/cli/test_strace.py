# SPDX-License-Identifier: MIT
"""System calls of the audio thread, as the kernel sees them."""
import collections
import re
import shutil
import subprocess
import time
import unittest

from harness import ALSA_CONFIG, FELT_CONFIG, TOOL, ToolTest, main

# Calls for the stream: waiting, the timer and the eventfds, samples to the file, the clock, and a check of the page faults once
# a second and of the time without a pause 50 times. The clock is a system call only where the vDSO has none.
ALLOWED = {"ppoll", "read", "write", "timerfd_settime", "ioctl", "clock_gettime", "getrusage"}


def traceable():
    if shutil.which("strace") is None:
        return "strace is not here"
    probe = subprocess.run(["strace", "-f", "-o", "/dev/null", "true"], capture_output=True, text=True, check=False)
    return "" if probe.returncode == 0 else f"ptrace is not permitted: {probe.stderr.strip().splitlines()[-1:]}"


WHY_NOT = traceable()


@unittest.skipIf(WHY_NOT, WHY_NOT)
class AudioThread(ToolTest):
    def calls(self, pcm):
        """Returns the audio thread's calls between its start and the end of its stream, in order."""
        trace = self.dir / "trace"
        began = time.monotonic()
        subprocess.run(["strace", "-f", "-o", trace, TOOL, "play", "park2016-1", "--duration", "1.5", "-D", pcm,
                        "--sample-format", "s32"], cwd=self.dir, env=self.env, check=True, capture_output=True)
        self.took_s = time.monotonic() - began
        lines = trace.read_text().splitlines()
        thread = next(line.split()[0] for line in lines if 'PR_SET_NAME, "tactor-audio"' in line)
        own = [line.split(None, 1)[1] for line in lines if line.split()[0] == thread]
        return [m[1] for text in own if (m := re.match(r"(?:<\.\.\. )?(\w+)(?:\(| resumed)", text))
                and "resumed" not in text.split("(")[0]]

    def check(self, pcm):
        calls = self.calls(pcm)
        # The stream runs from the first wait to the last.
        first = calls.index("ppoll")
        last = len(calls) - 1 - calls[::-1].index("ppoll")
        stream = collections.Counter(calls[first:last + 1])
        print(f"audio thread on {pcm.split(':')[0]}: {dict(stream)}")
        self.assertGreater(stream["ppoll"], 100)
        self.assertLessEqual(stream["getrusage"], 3 + 51 * self.took_s)
        self.assertEqual(set(stream) - ALLOWED, set())
        self.assertNotIn("futex", stream)
        return stream

    def test_calls_on_null(self):
        stream = self.check("null")
        # A period costs two calls: the timer is set, and awaited, by a thread that is late for several at once. The rest is the
        # cost of the stroke, by the 50 ms, over 750 periods: 0.15 for each.
        rest = sum(n for call, n in stream.items() if call not in ("ppoll", "timerfd_settime", "getrusage"))
        self.assertLessEqual(stream["timerfd_settime"], stream["ppoll"] + 1)
        self.assertLessEqual(rest, 0.15 * 750)

    def test_calls_on_a_file(self):
        self.check(f"raw:{self.dir}/out.raw")


@unittest.skipIf(WHY_NOT, WHY_NOT)
class DriveTime(ToolTest):
    def test_drive_time_that_is_kept_waits_for_no_disk(self):
        runtime = self.dir / "run"
        runtime.mkdir(mode=0o700)
        self.write("alsa.conf", ALSA_CONFIG + FELT_CONFIG)
        trace = self.dir / "trace"
        subprocess.run(["strace", "-f", "-e", "trace=pwrite64,fsync,fdatasync", "-o", trace, TOOL, "play", "park2016-1", "-D", "felt"],
                       cwd=self.dir, env=self.env | {"XDG_RUNTIME_DIR": str(runtime)}, check=True, capture_output=True)
        self.assertIn("pwrite64(", trace.read_text())
        self.assertNotIn("sync(", trace.read_text())


if __name__ == "__main__":
    main()
