# SPDX-License-Identifier: MIT
"""The site is made without a warning or a broken link, and has a page for each public header with its functions.

Usage: docs.py SOURCE_ROOT SITE COMMAND...     SITE: folder of the HTML that the command makes
"""
import os
import pathlib
import re
import subprocess
import sys


def main():
    root, html = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    # Python's warnings are about what a later version of Sphinx drops, not about the site.
    r = subprocess.run(sys.argv[3:], capture_output=True, text=True, check=False, env=os.environ | {"PYTHONWARNINGS": "ignore"})
    said = [line for line in (r.stdout + r.stderr).splitlines() if line]
    bad = ["the site is made with warnings, or not at all"] if said or r.returncode else []
    checks = 1
    for header in sorted((root / "include/tactor").glob("*.hpp")):
        if header.name == "tactor.hpp":  # includes the others, declares nothing
            continue
        checks += 1
        page = html / f"cpp-{header.stem}.html"
        names = set(re.findall(r"^(?:\[\[nodiscard\]\] )?TACTOR_API [^(=]*?(\w+)\(", header.read_text(encoding="utf-8"), re.M))
        text = page.read_text(encoding="utf-8") if page.exists() else ""
        bad += [f"{header.name}: its page lacks {name}" for name in sorted(names) if f">{name}<" not in text] if text else [f"{header.name}: has no page"]
    print(*said, *bad, sep="\n")
    print(f"{checks - len(bad)} passed, {len(bad)} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
