# SPDX-License-Identifier: MIT
"""The site is made without a warning or a broken link; its reference of the API has all public headers and links each example.

Usage: docs.py SOURCE_ROOT HTML_FOLDER COMMAND...     HTML_FOLDER: of the reference, which the command makes with the site
"""
import pathlib
import subprocess
import sys


def main():
    root, html = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    r = subprocess.run(sys.argv[3:], capture_output=True, text=True, check=False)
    said = [line for line in (r.stdout + r.stderr).splitlines() if line]
    bad = ["the site is made with warnings, or not at all"] if said or r.returncode else []
    checks = 1
    main_page = (html / "index.html").read_text(encoding="utf-8")
    for example in sorted((root / "examples").glob("*.cpp")):
        checks += 1
        page = f"{example.stem}_8cpp-example.html"
        if page not in main_page or not (html / page).exists():
            bad.append(f"examples/{example.name}: not linked (include/reference.dox)")
    for header in sorted((root / "include/tactor").glob("*.hpp")):
        checks += 1
        if not (html / f"{header.stem.replace('_', '__')}_8hpp.html").exists():
            bad.append(f"{header.name}: has no page (\\file is missing)")
    print(*said, *bad, sep="\n")
    print(f"{checks - len(bad)} passed, {len(bad)} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
