# SPDX-License-Identifier: MIT
"""Detects when the whole guest stood still, because its host gave the emulated processors no time."""
import os
import time

# Period of the checks; a processor that comes so much later was taken away.
EVERY_S, LATE_S = 0.005, 0.02


class Stalls:
    """A process above all others that only sleeps and wakes up."""

    def __init__(self):
        self.told, told = os.pipe()
        os.set_blocking(self.told, False)
        parent = os.getpid()
        if os.fork() == 0:
            os.close(self.told)
            self.watch(told, parent)
        os.close(told)

    @staticmethod
    def watch(told, parent):
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(99))
            before = time.monotonic()
            while os.getppid() == parent:
                time.sleep(EVERY_S)
                now = time.monotonic()
                if now - before - EVERY_S > LATE_S:
                    os.write(told, f"{now - before - EVERY_S}\n".encode())
                before = now
        finally:
            os._exit(0)

    def longest(self):
        """Returns the time since the last question, in seconds; 0 for none, and where no process may have the highest
        priority."""
        time.sleep(2 * EVERY_S)  # one that is not over yet
        try:
            return max(map(float, os.read(self.told, 65536).split()), default=0.0)
        except BlockingIOError:
            return 0.0
