# SPDX-License-Identifier: MIT
"""Holds the include directions: which folder may know which, and which library only one folder may know.

Usage: includes.py SOURCE_ROOT. Prints each include that breaks a rule, then counts.
"""
import pathlib
import re
import sys

# A folder may include itself and these.
MAY_INCLUDE = {
    "model": set(),
    "plan": {"model"},
    "synth": {"model", "plan"},
    "wav": {"model", "plan", "synth"},
    "rt": set(),
    "gpio": {"model", "rt"},
    "alsa": {"model", "rt"},
    "engine": {"model", "plan", "synth", "rt", "gpio"},
    "plot": set(),
    "cli": {"plot"},
    "server": set(),
}
# The folder that a public header belongs to; a folder may use the public headers of the folders it may include.
PUBLIC = {
    "api": None, "error": None, "version": None, "words": None, "geometry": None, "tactor": "engine",
    "array": "model", "path": "model", "setup": "model", "stroke": "model",
    "phantom": "plan", "plan": "plan", "percept": "plan", "fit": "plan",
    "render": "synth", "sample_format": None, "wav": "wav", "output_file": "wav",
    "gpio": "gpio", "realtime": "rt", "sink": None, "alsa": "alsa", "devices": "alsa", "player": "engine", "live": "engine",
    "asio": "engine",
}
USES_ALL_PUBLIC = {"cli", "plot", "server"}
# Header prefix: the only places that may include it.
ONLY_IN = {
    "alsa/asoundlib.h": ["src/alsa/"],
    "gpiod.h": ["src/gpio/line_v"],
    "pugixml.hpp": ["src/model/"],
    "toml++/": ["src/model/"],
    "boost/polygon": ["src/plan/"],
    "boost/asio": ["src/engine/", "src/server/", "include/tactor/asio.hpp"],
    "sndfile": [],
    "CLI/": ["src/cli/"],
    "cairo": ["src/plot/"],
    "nlohmann/": ["src/cli/", "src/server/"],
}
# Standard headers of threads and clocks that the pure folders must not see.
PURE = {"model", "plan", "synth"}
IMPURE = {"thread", "mutex", "condition_variable", "chrono", "atomic", "future", "poll.h", "unistd.h", "time.h"}

# But for the one file that reads what a user named, by descriptors.
IMPURE_IN = {"src/model/text_file.cpp": {"unistd.h"}}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)


def complaints(root, file):
    where = file.relative_to(root).as_posix()
    parts = where.split("/")
    folder = parts[1] if parts[0] == "src" and len(parts) > 2 else None
    for header in INCLUDE.findall(file.read_text(encoding="utf-8")):
        for prefix, places in ONLY_IN.items():
            if header.startswith(prefix) and not any(where.startswith(p) for p in places):
                yield f"{where}: includes {header}, which only {', '.join(places)} may"
        if parts[0] == "include" and not header.startswith("tactor/") and "/" in header \
                and where != "include/tactor/asio.hpp":  # there for those who use Asio
            yield f"{where}: a public header includes {header}"
        if folder is None:
            continue
        if folder in PURE and header in IMPURE - IMPURE_IN.get(where, set()):
            yield f"{where}: {folder} is pure and includes {header}"
        if header.startswith("tactor/"):
            name = header[len("tactor/"):-len(".hpp")]
            if name not in PUBLIC:
                yield f"{where}: {header} belongs to no folder (PUBLIC in tests/includes.py)"
                continue
            owner = PUBLIC[name]
            if owner and folder not in USES_ALL_PUBLIC and owner != folder and owner not in MAY_INCLUDE[folder]:
                yield f"{where}: {folder} may not know {owner} ({header})"
        elif header.split("/")[0] in MAY_INCLUDE and "/" in header:
            owner = header.split("/")[0]
            if (root / "src" / header).exists() and owner != folder and owner not in MAY_INCLUDE[folder]:
                yield f"{where}: {folder} may not know {owner} ({header})"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = [f for top in ("src", "include") for f in sorted((root / top).rglob("*.[ch]pp"))]
    bad = [c for f in files for c in complaints(root, f)]
    for line in bad:
        print(line)
    broken = len({c.split(":")[0] for c in bad})
    print(f"{len(files) - broken} passed, {broken} failed")
    return 1 if bad or not files else 0


if __name__ == "__main__":
    sys.exit(main())
