# SPDX-License-Identifier: MIT
"""Support for the tests of installing: running a command that must succeed, and a folder for the tests."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from harness import ROOT, main  # noqa: E402,F401

BUILD = pathlib.Path(sys.argv[3]).resolve()
CONSUMER = ROOT / "tests/install/consumer"


def run(*args, **more):
    r = subprocess.run([str(a) for a in args], capture_output=True, text=True, check=False, **more)
    assert r.returncode == 0, f"{args}: {r.stdout[-3000:]}{r.stderr}"
    return r.stdout


class FolderTest(unittest.TestCase):
    """Makes one folder, cls.dir, for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.dir = pathlib.Path(folder.name)
