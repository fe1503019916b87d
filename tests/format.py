# SPDX-License-Identifier: MIT
"""Checks that all C++ files are formatted, and that the man pages are clean.

Usage: format.py SOURCE_ROOT. Versions of clang-format differ in taste: only version 14 (Debian 12's) counts.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FORMAT_VERSION = 14


def run(*args):
    environment = os.environ | {"LC_ALL": "C.UTF-8", "MANWIDTH": "80", "MANROFFOPT": "", "MAN_KEEP_FORMATTING": "1"}
    r = subprocess.run(args, capture_output=True, text=True, env=environment, check=False)
    return r.returncode, r.stdout, r.stderr


def unformatted(files):
    """Formats all files in one run: a tenth of the time."""
    status, _, said = run("clang-format", "--dry-run", "-Werror", *map(str, files))
    found = {m[1]: m[0] for m in reversed(list(re.finditer(r"^(/.*?):\d+:\d+: error: .*", said, re.M)))}
    for f in files:
        if str(f) in found:
            yield f"{f}: not formatted: clang-format -i {f} ({found[str(f)]})"
    if status and not found:
        yield f"clang-format: {said.strip()}"


def braced(root, files):
    """Returns files with braces around one statement. clang-format can remove them, but breaks lines after lambdas in
    another way then; so only the non-space characters are compared."""
    with tempfile.NamedTemporaryFile("w", suffix=".clang-format") as style:
        style.write((root / ".clang-format").read_text(encoding="utf-8") + "RemoveBracesLLVM: true\n")
        style.flush()

        def differ(some):
            _, said, _ = run("clang-format", f"--style=file:{style.name}", *map(str, some))
            return "".join(said.split()) != "".join("".join(f.read_text(encoding="utf-8").split()) for f in some)

        if differ(files):
            yield from (f"{f}: braces around one statement: leave them out" for f in files if differ([f]))


def unclean(page):
    _, said, _ = run("mandoc", "-Tlint", str(page))
    # Another page that is not installed here says nothing about this one.
    yield from (line for line in said.splitlines() if "referenced manual not found" not in line)
    _, _, said = run("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(page))
    # Lines in a narrow table column that stay short are a matter of taste, and of groff's version; and page ends do not matter
    # on a terminal.
    matters = (line for line in said.splitlines() if "cannot adjust line" not in line and "not fit on one page" not in line)
    yield from (f"{page}: {line}" for line in matters)


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    passed, failed, skipped = 0, 0, 0
    version = re.search(r"version (\d+)", run("clang-format", "--version")[1]) if shutil.which("clang-format") else None
    if version and int(version[1]) == FORMAT_VERSION:
        files = [f for top in ("src", "include", "tests", "examples") for f in sorted((root / top).rglob("*.[ch]pp"))]
        bad = list(unformatted(files)) + list(braced(root, files))
        print(*bad, sep="\n", end="\n" if bad else "")
        passed, failed = passed + max(len(files) - len(bad), 0), failed + len(bad)
    else:
        print(f"SKIPPED: formatting: clang-format {FORMAT_VERSION} is not here")
        skipped += 1
    for page in sorted((root / "man").glob("*.[1-8]")):
        bad = list(unclean(page))
        print(*bad, sep="\n", end="\n" if bad else "")
        passed, failed = passed + (not bad), failed + bool(bad)
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
