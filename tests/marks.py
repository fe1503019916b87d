# SPDX-License-Identifier: MIT
"""The library names its fields, and has marks for options and commands: {soa_s}, {timing=fit}, {command:devices}.

No text in it has an option or a command of the tool; each mark is a row of the table of options, a command, or an argument of the
library that front ends have words of their own for (core/marks.hpp, options/words.hpp).

Usage: marks.py SOURCE_ROOT. Prints each text that breaks a rule, then counts.
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
    """Texts with what follows them at once, and without comments."""
    code = COMMENT.sub(lambda m: m[1] or "", file.read_text(encoding="utf-8"))
    code = re.sub(r"^#include.*$", "", code, flags=re.M)
    return [re.sub(r'"\s*"', "", text)[1:-1] for text in LITERALS.findall(code)]


def complaints(text, in_library, commands, names):
    if in_library:
        own = OTHER_PROGRAMS.sub("", text)
        if "--" in own or "-D " in own:
            yield "an option of the tool"
        if m := re.search(rf"\btactor (?:{'|'.join(sorted(commands))})\b", own):
            yield f"a command of the tool: {m[0]}"
    for name in MARK.findall(text):
        if name not in names | ARGUMENTS and name.removeprefix("command:") not in commands:
            yield f"{name} is neither option nor command"


def main():
    src = pathlib.Path(sys.argv[1]).resolve() / "src"
    table = (src / "options/table.cpp").read_text(encoding="utf-8")
    names = set(re.findall(r'\.(?:name|field) = "(\w+)"', table))
    commands = {name for f in src.glob("cli/**/*.cpp") for name in re.findall(r'add_subcommand\(\s*"(\w+)"', f.read_text(encoding="utf-8"))}
    texts, broken, marks = 0, 0, 0
    for folder in LIBRARY + ALSO_MARKED:
        for file in sorted((src / folder).glob("**/*.[ch]pp")):
            for text in literals(file):
                texts += 1
                marks += len(MARK.findall(text))
                bad = list(complaints(text, folder in LIBRARY, commands, names))
                broken += 1 if bad else 0
                for why in bad:
                    print(f"{file.relative_to(src)}: {why}: {text[:80]}")
    print(f"{texts - broken} passed, {broken} failed")
    return 1 if broken or marks < 40 or len(names) < 60 or len(commands) < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
