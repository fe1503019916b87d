# SPDX-License-Identifier: MIT
"""A small disk for a test, which can be full or read-only for real. Needs root, and a kernel that lets root mount."""
import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

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
    """Mounts the folder `disk` of the test; unmounted when the test ends in any way."""

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
