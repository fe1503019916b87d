# SPDX-License-Identifier: MIT
"""Code in documents: commands, names of commands, and files, in the order of the text."""
import dataclasses
import re

PROGRAMS = r"(?:\S*/)?(?:tactor|quickstart|run)|sudo|meson|man|c\+\+|cp|dpkg-\w+|grep|ulimit|kill|python3"


@dataclasses.dataclass
class Block:
    kind: str  # command, name (of a command of the tool), or what a block is: toml, csv, c++, python, unit, boot, cmake, drawing, formula
    text: str
    line: int


def classify(text):
    """What a block of code is; whatever it is not known to be is commands."""
    for kind, pattern in (("c++", r"^#include"), ("unit", r"^\[Service\]$"), ("toml", r"^\[+\w+\]+$"), ("csv", r"^t_s,"), ("boot", r"^dtoverlay="), ("cmake", r"^find_package\("),
                          ("drawing", r"-->"),
                          ("formula", r"^(?:[A-Za-z_]\w*(?:\(\w\))? = |polarity \* )")):
        if re.search(pattern, text, re.M):
            return kind
    return "command"


def commands_in(text, line):
    """Returns the commands of a manual's block: a backslash continues a line, two spaces outside quotes begin an
    explanation."""
    joined, number = "", line
    for offset, part in enumerate(text.split("\n")):
        number = number if joined else line + offset
        joined += part.strip() if joined else part.rstrip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        if joined and not joined.startswith((" ", "#")):  # an indented line continues an explanation
            # Two quotes or none before the gap.
            command = re.match(r"""((?:[^"' ]|"[^"]*"|'[^']*'| (?! ))+)""", joined)[1]
            yield Block("command", command, number)
        joined = ""


def inline(code, line):
    """Classifies code within a sentence: a command with arguments, a name without."""
    if not re.match(rf"(?:{PROGRAMS}) \S", code):
        return []
    name = re.fullmatch(r"tactor [\w-]+", code)
    return [Block("name" if name else "command", code, line)]


def copied_lines(text, line):
    """Returns the commands of a block as a reader copies them: whole lines with their explanations."""
    found, open_line = [], False
    for i, part in enumerate(text.split("\n")):
        if open_line:
            found[-1] = Block("command", found[-1].text.removesuffix("\\") + part.strip(), found[-1].line)
        elif part.strip():
            found.append(Block("command", part.rstrip(), line + i))
        open_line = part.endswith("\\")
    return found


def code_in_block(text, line, commands=commands_in):
    kind = classify(text)
    return commands(text, line) if kind == "command" else [Block(kind, text, line)]


def code_of_markdown(text):
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        if lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            end = at
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            yield from code_in_block("\n".join(part[4:] for part in lines[at:end]).rstrip("\n") + "\n", at + 1, copied_lines)
            at = end
            continue
        end = at + 1
        while lines[at].strip() and end < len(lines) and lines[end].strip():
            end += 1
        paragraph = "\n".join(lines[at:end])
        for code in re.finditer(r"`([^`]+)`", paragraph):  # may continue over the end of a line
            yield from inline(" ".join(code[1].split()), at + 1 + paragraph.count("\n", 0, code.start()))
        at = end


def plain(text):
    """Replaces escapes of roff by the characters that they print."""
    for escape, character in (("\\(dq", '"'), ("\\(aq", "'"), ("\\-", "-"), ("\\&", ""), ("\\e", "\\")):
        text = text.replace(escape, character)
    return text


def code_of_man(text, sentences=True):
    """Returns the code of a page; `sentences`: also from its sentences."""
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        line = lines[at]
        if line.startswith(".Bd -literal"):
            end = lines.index(".Ed", at)
            block = plain("\n".join(lines[at + 1:end]) + "\n")
            yield from code_in_block(block, at + 2)
            at = end
        elif line.startswith(".Dl "):
            yield from code_in_block(plain(line[4:]), at + 1)
        elif line.startswith(".Ic ") and sentences:
            yield from inline(plain(line[4:]), at + 1)
        at += 1


def code_of_script(text):
    """Returns commands of the tool in comments: indented, a line each."""
    for number, line in enumerate(text.split("\n"), 1):
        if command := re.match(r"# {2,}(tactor .*)", line):
            yield Block("command", command[1], number)
