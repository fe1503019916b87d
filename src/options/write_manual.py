# SPDX-License-Identifier: MIT
"""Writes what the manual says of options from their table; the prose stays.

* An entry such as ".It Fl -soa Ar S", or ".It Cm slope Ar A" of an option that only a file sets, with a line ".br" gets its head, and after that
  line range, default and commands.
* The comment ".\\" Common options" stands over a list of the options that the page's command shares with others, by group.
"""
import re
import textwrap

COMMON = '.\\" Common options, written by src/options/write.py:\n'
WORD = re.compile(r"(?P<Cm>[a-z0-9][a-z0-9-]*)|(?P<Ar>[A-Z][A-Z_]*(?:\.[a-z]+)?)|(?P<mark>[][:|-])")


def form(text):
    """Returns the macros for a value's type: "HZ[:DEPTH]" is an argument with an optional one."""
    out, current, joined = [], "", False
    for m in WORD.finditer(text):
        if m.lastgroup == "mark":
            if m[0] != "]":
                out += {"[": ["Ns", "Op"], "|": ["|"], ":": [":"], "-": ["Ns", "-"]}[m[0]]
            joined = m[0] in ":-"
            current = "" if m[0] == "[" else current
            continue
        out += ["Ns"] * joined + [m.lastgroup] * (joined or m.lastgroup != current) + [m[0]]
        current, joined = m.lastgroup, False
    return " ".join(out)


def macro(mark):
    """Returns the macros for a mark without its braces: "timing=fit"."""
    name, _, value = mark.partition("=")
    return f"Fl -{name.replace('_', '-')}" + ("" if value in ("", "true") else f" {form(value)}")


def sentence(text):
    """Returns the lines of a sentence with marks."""
    lines = []
    for i, part in enumerate(re.split(r"\{([^}]+)\}", text + ".")):
        if i % 2:
            lines.append("." + macro(part))
        else:
            end = re.match(r"[.;,]?", part)[0] if i else ""
            lines[-1:] = [f"{lines[-1]} {end}"] if end else lines[-1:]
            lines += textwrap.wrap(part[len(end):].strip(), 78)
    return lines


def usual(row):
    """Returns the default as the row's help says it; where it marks a choice instead, that of a stroke without options."""
    about = row["manual"]
    if found := re.search(r"\(default:? ([^);]+)", about["help"]):
        return found[1]
    value = about["default"]
    return value if value in row["choices"] else ""


def facts(row, with_commands):
    about = row["manual"]
    lines = sentence("Range: " + about["range"]) if row["range"] else []
    lines += sentence("Default: " + usual(row)) if usual(row) else []
    lines += sentence("Not with {" + about["rival"] + "}") if about["rival"] else []
    lines += sentence("Needs " + about["needs"].replace("|", " or ")) if about["needs"] else []
    commands = f".Cm {' , '.join(about['commands'])} ."
    return lines + ([".Cm [defaults]", "of a file sets it, for", commands] if about["file_only"] else ["Commands:", commands] * with_commands)


def written(page, text, *, rows):
    """Returns the text of a page, named such as tactor-play.1, with all that is written from these rows."""
    by_name = {row["name"]: row for row in rows if row["manual"]["commands"]}
    command = page.partition("-")[2].partition(".")[0]

    def entry(found):
        row = by_name[found[1].replace("-", "_")]
        letter = f"{row['manual']['letter']} , " * bool(row["manual"]["letter"])
        name = f"Cm {found[1]}" if row["manual"]["file_only"] else f"Fl {letter}-{found[1]}"
        head = f".It {name} {form(row['manual']['type'])}".rstrip()
        return "\n".join([head, found[2] + ".br", *facts(row, command == "options")]) + "\n"

    text = re.sub(r"^\.It (?:Fl (?:\w , )?-|Cm )([a-z-]+)(?: .*)?\n((?:(?!\.It |\.El|\.br$).*\n)*)\.br\n(?:(?!\.It |\.El).*\n)*", entry, text, flags=re.M)
    groups = {}
    for row in by_name.values():
        about = row["manual"]
        if command in about["commands"] and len(about["commands"]) > 1 and not about["file_only"]:
            groups.setdefault(about["group"], []).extend([about["letter"]] * bool(about["letter"]) + ["-" + row["name"].replace("_", "-")])
    common = "".join(f".It {group}\n.Fl {' , '.join(names)}\n" for group, names in groups.items())
    return re.sub(rf"^{re.escape(COMMON)}(?:.*\n)*?\.El\n", lambda m: f'{COMMON}.Bl -tag -width "Real time" -compact\n{common}.El\n', text, flags=re.M)
