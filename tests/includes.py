# SPDX-License-Identifier: MIT
"""Holds the include directions: which folder may know which, and which library only one folder may know.

Usage: includes.py SOURCE_ROOT. Prints each include that breaks a rule, then counts.
"""
import graphlib
import pathlib
import re
import sys

# A folder may include itself and these. Also lists folders within another that have separate rules.
MAY_INCLUDE = {
    "core": set(),
    "options": {"core", "percept"},
    "files": {"core", "files/json"},
    "files/json": {"core"},
    "files/plan": {"core", "files", "files/json", "plan", "percept", "synth"},
    "plan": {"core"},
    "percept": {"core", "plan"},
    "synth": {"core", "plan"},
    "rt": {"core"},
    "sink": {"core", "rt"},
    "sink/alsa": {"core", "rt", "sink"},
    "sink/wav": {"core", "files", "plan", "synth", "sink"},
    "amplifier": {"core", "rt"},
    "desktop": {"core", "rt"},
    "engine": {"core", "plan", "synth", "rt", "sink", "amplifier"},
    "session": {"core", "desktop", "files", "files/json", "files/plan", "options", "rt"},
    "plot": set(),
    "net": {"core"},
    "study": {"files/json", "files/plan", "options", "session", "net"},
    "server": {"files/json", "files/plan", "net", "options", "plot", "session"},
    "cli": {"files/json", "files/plan", "options", "session", "plot", "study", "net", "server"},
    "python": {"files/plan", "options", "session", "plot", "study"},
}
# The folder that a public header belongs to; a folder may use the public headers of the folders it may include.
PUBLIC = {
    "api": None, "error": None, "version": None, "lines": None, "tactor": "engine",
    "array": "core", "path": "core", "stroke": "core", "choices": "core", "waveform": "core", "setup": "files",
    "phantom": "plan", "plan": "plan", "percept": "percept", "render": "synth",
    "sink": None, "alsa": "sink/alsa", "player": "engine", "asio": "engine",
}
USES_ALL_PUBLIC = {"cli", "files/plan", "options", "plot", "python", "server", "session", "study"}
# Inner headers of the library that the tool may include: no program that embeds it needs these.
INSIDE = {
    "cli": {"core/kind_names.hpp", "core/members.hpp", "core/owned.hpp", "core/sha256.hpp", "core/split.hpp", "core/suggest.hpp", "core/words.hpp", "files/setup_text.hpp", "files/stroke_format.hpp", "files/text_file.hpp", "percept/compare.hpp", "rt/clock.hpp", "rt/system_files.hpp", "rt/thread.hpp", "sink/wav/wav.hpp", "synth/score/score_view.hpp"},
    "session": {"core/start_times.hpp", "core/trajectory/recorded_points.hpp", "percept/observer.hpp", "plan/curve_impl.hpp"},
    "study": {"amplifier/line.hpp", "core/baud_rates.hpp", "core/marks.hpp", "core/members.hpp", "core/owned.hpp", "core/path/shape.hpp", "core/sha256.hpp", "core/split.hpp", "core/start_times.hpp", "core/suggest.hpp", "core/trajectory/impl.hpp", "core/words.hpp", "files/output_file.hpp", "files/setup_text.hpp", "files/text_file.hpp", "files/toml_reader.hpp", "rt/clock.hpp", "rt/event_fd.hpp", "rt/system_files.hpp", "rt/thread.hpp", "synth/mix/converter.hpp", "synth/score/drive_room.hpp", "synth/score/joined.hpp"},
    "plot": {"core/owned.hpp", "core/split.hpp", "core/words.hpp", "files/output_file.hpp", "percept/compare.hpp", "synth/score/score_view.hpp"},
    "server": {"core/bounds.hpp", "core/kind_names.hpp", "core/members.hpp", "core/path/shape.hpp", "core/refused.hpp", "core/split.hpp", "core/start_times.hpp", "core/suggest.hpp", "core/trajectory/spans.hpp", "core/words.hpp", "files/stroke_format.hpp", "percept/compare.hpp", "rt/clock.hpp", "sink/wav/wav.hpp", "synth/score/levels.hpp"},
    "python": {"core/access.hpp", "core/path/impl.hpp", "core/trajectory/impl.hpp", "core/words.hpp", "files/output_file.hpp", "files/setup_text.hpp", "files/stroke_format.hpp", "files/text_file.hpp", "percept/compare.hpp", "sink/wav/wav.hpp"},
}
# Header prefix: the only places that may include it.
ONLY_IN = {
    "alsa/asoundlib.h": ["src/sink/alsa/"],
    "gpiod.h": ["src/amplifier/line_v"],
    "pugixml.hpp": ["src/files/"],
    "sha2.h": ["src/core/sha256.cpp"],
    "toml++/": ["src/files/", "src/study/"],
    "boost/polygon": ["src/plan/"],
    "boost/asio": ["src/engine/", "src/net/", "src/server/", "include/tactor/asio.hpp"],
    "CLI/": ["src/cli/"],
    "pybind11/": ["src/python/"],
    "lo/": ["src/net/osc.cpp"],
    "systemd/": ["src/desktop/"],
    "kainjow/": ["src/study/"],
    "nlohmann/": ["src/cli/", "src/files/json/", "src/files/plan/", "src/net/", "src/python/", "src/server/", "src/session/", "src/study/"],
}
# Standard headers of threads and clocks that the pure folders must not see.
PURE = {"core", "files", "plan", "percept", "synth"}
IMPURE = {"thread", "mutex", "condition_variable", "chrono", "atomic", "future", "poll.h", "unistd.h", "time.h"}

# Exceptions: reading and writing files that a user named, by descriptors, with a record of inputs; and a guess where to look
# first, which threads share and no answer depends on.
IMPURE_IN = {"src/core/owned.hpp": {"unistd.h"}, "src/files/text_file.cpp": {"mutex", "unistd.h"}, "src/files/output_file.cpp": {"unistd.h", "poll.h"},
             "src/plan/faces/layout_impl.hpp": {"atomic"}}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)


def folder_name(parts):
    """Returns the innermost folder with rules for a file below src."""
    return "/".join(parts[:2]) if "/".join(parts[:2]) in MAY_INCLUDE else parts[0]


def complaints(root, file):
    where = file.relative_to(root).as_posix()
    parts = where.split("/")
    folder = folder_name(parts[1:]) if parts[0] == "src" and len(parts) > 2 else None
    for header in INCLUDE.findall(file.read_text(encoding="utf-8")):
        for prefix, places in ONLY_IN.items():
            if header.startswith(prefix) and not any(where.startswith(p) for p in places):
                yield f"{where}: includes {header}, which only {', '.join(places)} may"
        if parts[0] == "include" and not header.startswith("tactor/") and "/" in header \
                and where != "include/tactor/asio.hpp":  # there for users of Asio
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
            owner = folder_name(header.split("/"))
            if (root / "src" / header).exists() and owner != folder and owner not in MAY_INCLUDE[folder] \
                    and header not in INSIDE.get(folder, ()):
                yield f"{where}: {folder} may not know {owner} ({header})"


def find_rings(root, files):
    """Yields a complaint about folders of any depth that include each other in a ring."""
    below = {}
    for file in files:
        where = file.relative_to(root).as_posix()
        if not where.startswith("src/"):
            continue
        own = where.removeprefix("src/").rpartition("/")[0]
        for header in INCLUDE.findall(file.read_text(encoding="utf-8")):
            other = header.rpartition("/")[0]
            if (root / "src" / header).exists() and other != own:
                below.setdefault(own, set()).add(other)
    try:
        graphlib.TopologicalSorter(below).prepare()
    except graphlib.CycleError as e:
        yield f"src/{e.args[1][0]}: a ring of folders: {' includes '.join(reversed(e.args[1]))}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = [f for top in ("src", "include") for f in sorted((root / top).rglob("*.[ch]pp"))]
    bad = [c for f in files for c in complaints(root, f)] + list(find_rings(root, files))
    # An unused entry of the list is an error.
    for folder, headers in INSIDE.items():
        used = {h for f in (root / "src" / folder).rglob("*.[ch]pp") for h in INCLUDE.findall(f.read_text(encoding="utf-8"))}
        bad += [f"tests/includes.py: nobody in {folder} includes {h} (INSIDE)" for h in sorted(headers - used)]
    for line in bad:
        print(line)
    broken = len({c.split(":")[0] for c in bad})
    print(f"{len(files) - broken} passed, {broken} failed")
    return 1 if bad or not files else 0


if __name__ == "__main__":
    sys.exit(main())
