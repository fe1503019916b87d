# SPDX-License-Identifier: MIT
"""Holds the library's texts to its own names, and marks to names that front ends know.

Usage: marks.py SOURCE_ROOT. No text of the library has an option or a command of the tool. Each mark ({soa_s}, {timing=fit}, {command:devices})
names a row of the table of options, a command, or an argument for which front ends have words (core/marks.hpp, options/option.hpp).
"""
import pathlib
import re
import sys

LIBRARY = ("core", "files", "plan", "percept", "synth", "rt", "sink", "amplifier", "engine", "net")
ALSO_MARKED = ("options", "session", "server")
ARGUMENTS = {"force", "wider"}
OTHER_PROGRAMS = re.compile(r"systemctl --user|pulseaudio --start|groupadd --system --force|--cap-add [A-Z_]+")
COMMENT = re.compile(r'//[^\n]*|("(?:[^"\\\n]|\\.)*")')
LITERALS = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*')
MARK = re.compile(r"\{([a-z_]+|command:[a-z_]+)(?=[=|}])")


def literals(file):
    """Returns the texts of a file, each with those that follow it at once, without comments."""
    code = COMMENT.sub(lambda m: m[1] or "", file.read_text(encoding="utf-8"))
    code = re.sub(r"^#include.*$", "", code, flags=re.M)
    return [re.sub(r'"\s*"', "", text)[1:-1] for text in LITERALS.findall(code)]


def main():
    src = pathlib.Path(sys.argv[1]).resolve() / "src"
    names = set(re.findall(r'\.(?:name|field) = "(\w+)"', (src / "options/table.cpp").read_text(encoding="utf-8")))
    commands = set(re.findall(r'\bcommand\{"(\w+)"', (src / "cli/main.cpp").read_text(encoding="utf-8")))
    known = names | ARGUMENTS | {f"command:{c}" for c in commands}
    tool = re.compile(rf"--|-D |\btactor (?:{'|'.join(commands)})\b")
    bad, texts = [], 0
    for folder in LIBRARY + ALSO_MARKED:
        for file in sorted((src / folder).glob("**/*.[ch]pp")):
            for text in literals(file):
                texts += 1
                if folder in LIBRARY and tool.search(OTHER_PROGRAMS.sub("", text)) or not known.issuperset(MARK.findall(text)):
                    bad.append(f"{file.relative_to(src)}: {text[:80]}")
    print(*bad, f"{texts - len(bad)} passed, {len(bad)} failed", sep="\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
