# SPDX-License-Identifier: MIT
"""Runs the guest's tests. Usage: main.py SOURCE_ROOT BUILD_FOLDER [test_X[.CLASS[.TEST]] ...]"""
import os
import pathlib
import sys
import time
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))

# Number of tries of a test during which the guest stood still each time.
ATTEMPTS = 3
# Period of the checks; a processor that comes so much later was taken away.
EVERY_S, LATE_S = 0.005, 0.02


class Stalls:
    """A process above all others that only sleeps and wakes up: it sees when the host gave the emulated processors no time."""

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


class Timed(unittest.TextTestResult):
    """Prints the time of each test, and how long the guest stood still meanwhile. A card runs dry where its processor is
    taken away: a test that failed then shows nothing, and is tried again."""

    stalls = None
    attempt = 0

    def startTest(self, test):
        self.began = time.monotonic()
        self.stalls.longest()
        super().startTest(test)

    def stopTest(self, test):
        test.stalled_s = self.stalls.longest()
        still = f", of which the guest stood still for {1e3 * test.stalled_s:.0f} ms at once" if test.stalled_s else ""
        self.stream.writeln(f"    {time.monotonic() - self.began:.1f} s{still}")
        super().stopTest(test)

    @classmethod
    def again(cls, test):
        t = whole(test)
        return cls.attempt < ATTEMPTS and getattr(t, "tried_again", True) and getattr(t, "stalled_s", 0.0) > 0.0

    def printErrorList(self, flavour, errors):
        for e in errors:
            super().printErrorList("TO BE TRIED AGAIN" if self.again(e[0]) else flavour, [e])


def whole(test):
    """Returns the test of a part of a test."""
    return getattr(test, "test_case", test)


def flatten(suite):
    for t in suite:
        yield from flatten(t) if isinstance(t, unittest.TestSuite) else (t,)


def run(tests):
    """Returns the failed and skipped tests."""
    failed, skipped = [], []
    for Timed.attempt in range(1, ATTEMPTS + 1):
        result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2, resultclass=Timed).run(unittest.TestSuite(tests))
        skipped += result.skipped
        bad = list(dict.fromkeys(whole(t) for t, _ in result.failures + result.errors))
        tests = [t for t in bad if Timed.again(t)]
        failed += [t for t in bad if t not in tests]
        for t in tests:
            print(f"AGAIN: {t}: it failed while the guest stood still for {1e3 * t.stalled_s:.0f} ms")
        if not tests:
            break
    return failed, skipped


def main():
    Timed.stalls = Stalls()
    names = sys.argv[3:] or sorted(p.stem for p in HERE.glob("test_*.py"))
    tests = [t for n in names for t in flatten(unittest.defaultTestLoader.loadTestsFromName(n))]
    failed, skipped = run(tests)
    for test, why in skipped:
        print(f"SKIPPED: {test}: {why}")
    print(f"{len(tests) - len(failed) - len(skipped)} passed, {len(failed)} failed, {len(skipped)} skipped")
    return 1 if failed or not tests else 0


if __name__ == "__main__":
    sys.exit(main())
