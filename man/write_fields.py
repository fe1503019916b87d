#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the lists of fields in tactor-json(5) from the schemas that say what each field is.

Run as: python3 man/write_fields.py FOLDER_OF_SCHEMAS     e.g. build-tests/src/cli/schemas
"""
import json
import pathlib
import re
import sys
import textwrap

PAGE = pathlib.Path(__file__).resolve().parent / "tactor-json.5"
SECTION = "Slow actuators"
MARK = re.compile(rf"(?P<Fl>(?<![\w-])--?[a-zA-Z][a-z-]*)|(?P<Xr>[a-z][a-z.-]+\(\d\))|(?P<Cm>\b[a-z]+(?:_[a-z0-9]+)+\b|\[[a-z]+\](?!\.))|(?P<Sx>{SECTION})")


def macro(m):
    """Returns the macro of a mark: an option, a page, a field or a section."""
    text = m[0]
    if m.lastgroup == "Fl":
        return f".Fl {text[1:]}"
    if m.lastgroup == "Xr":
        return f".Xr {text[:-3]} {text[-2]}"
    return f".{m.lastgroup} {text}"


def sentence(text):
    """Returns the lines of a text in which options, fields and pages are marked."""
    lines, at = [], 0
    for m in MARK.finditer(text):
        lines += textwrap.wrap(text[at:m.start()].strip(), 78)
        end = re.match(r"[.,;:)]*", text[m.end():])[0]
        lines.append(" ".join([macro(m), *end]))
        at = m.end() + len(end)
    return lines + textwrap.wrap(text[at:].strip(), 78)


def described(text):
    return [line for one in re.split(r"(?<=\.) (?=[A-Z])", text) for line in sentence(one)]


def inner(schema):
    """Returns the schema of what has members below a field, and the mark of a list."""
    if "items" in schema:
        below, mark = inner(schema["items"])
        return below, "[]" + mark
    return schema.get("properties"), ""


def entries(properties, at=""):
    """Returns the lines of all fields; those in a row that say the same are one entry."""
    lines, names = [], []
    fields = list(properties.items())
    for i, (name, schema) in enumerate(fields):
        names.append(at + name)
        below, mark = inner(schema)
        text = schema.get("description")
        following = fields[i + 1] if i + 1 < len(fields) else ("", {})
        if below is None and text and following[1].get("description") == text and len(" , ".join([*names, at + following[0]])) < 90:
            continue
        lines.append(f".It Cm {' , '.join(names)}")
        names = []
        lines += [f".Dq {schema['const']}"] if text is None else described(text + ":" * bool(below))
        lines += entries(below, f"{at}{name}{mark}.") if below else []
    return lines


def written(page, schemas):
    """Returns the page with the lists of all schemas that describe their fields."""
    for schema in schemas:
        properties = schema["properties"]
        name = properties["schema"]["const"]
        if any("description" not in field for field in properties.values() if "const" not in field) or "$defs" in schema:
            continue  # those are described by hand
        start = page.index(".Bl -tag -width Ds\n", page.index(f".Ss {name}\n"))
        end = page.index(".El\n", start)
        page = page[:start] + "\n".join([".Bl -tag -width Ds", *entries(properties)]) + "\n" + page[end:]
    return page


def read(folder):
    return [json.loads(file.read_text(encoding="utf-8")) for file in sorted(pathlib.Path(folder).glob("*.schema.json"))
            if "protocol" not in file.name]


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), read(sys.argv[1])), encoding="utf-8")
