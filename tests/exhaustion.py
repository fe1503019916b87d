# SPDX-License-Identifier: MIT
"""Holds that every public function that may throw is tried without descriptors and without memory.

What is declared in a public header and not noexcept stands in one of the tables tests/engine/exhaustion_calls.cpp, each
overload in a separate row: under its name, with that of its class before it ("path::meets_x"), and is called in that
row. Further rows for the same have more to say after a comma ("path::from_svg, no path"). from_string() has one row for
all, which names each enumeration. UNTRIED has the others, with the reason.

The headers are taken apart by their braces, not as C++. It does not see what macros declare other than TACTOR_KIND, functions whose type of
result has parentheses in it, defaulted functions (those of plain values, which throw what their members do), and what a
function of the user's throws. That a row calls this overload, and not another of the same name, is for its author to say.

Usage: exhaustion.py SOURCE_ROOT. Prints what is missing, then counts.
"""
import collections
import pathlib
import re
import sys

UNTRIED = {
    "async_wait": "Boost.Asio's own throws; what the player throws comes as the exception that the handler gets",
    "async_play": "the same",
    "play": "it calls make_plan(), open_alsa() and the player, which have rows",
}
IGNORED = re.compile(r"//[^\n]*|/\*.*?\*/|^\s*#(?:[^\n]*\\\n)*[^\n]*", re.S | re.M)
ACCESS = re.compile(r"^\s*(public|protected|private)\s*:(?!:)")
TYPE = re.compile(r"^(?:template\s*<.*>\s*)?(class|struct|enum)\b(?:\s+class)?(?:\s+TACTOR_API)?\s+([\w:]+)", re.S)
NAME = re.compile(r"(operator\s*(?:\(\)|[^\s\w(]+)|~?\w+(?:<[\w:]+>)?)\s*\(")
VALUE = re.compile(r"(?:(?!operator)[^(=])*=")  # of a constant or a member
KIND = re.compile(r"\bTACTOR_KIND\((\w+)\)")  # declares from_string(), which throws
ROW = re.compile(r'\{"([\w:]+(?:operator[^\w",]+)?)(,[^"]*)?",')


def statements(text):
    """Returns the parts between semicolons and closing braces, each as its head and the content of its braces (or None)."""
    begin = i = 0
    while i < len(text):
        c = text[i]
        if c == "(":
            i = find_end(text, i)
        elif c == ";":
            yield text[begin:i].strip(), None
            begin = i + 1
        elif c == "{":
            head, end = text[begin:i].strip(), find_end(text, i)
            # After a type, a namespace or a function there is a body; all other braces hold a value.
            if re.match(r"(inline )?namespace\b", head) or TYPE.match(ACCESS.sub("", head)) or "(" in head and not head.endswith("="):
                yield head, text[i + 1:end]
                begin = end + 1
            i = end
        elif c == ":" and ACCESS.match(text[begin:i + 1]):
            yield text[begin:i + 1].strip(), None
            begin = i + 1
        i += 1


def find_end(text, at):
    """Returns the end of the bracket at a place."""
    deep = 0
    for i in range(at, len(text)):
        deep += (text[i] in "({[") - (text[i] in ")}]")
        if deep == 0:
            return i
    sys.exit(f"a bracket is not closed: {text[at:at + 60]}")


def without_template(head):
    """Returns a declaration without "template <...>" and attributes."""
    while m := re.match(r"template\s*<", head):
        deep, i = 1, m.end()
        while deep:
            deep += (head[i] == "<") - (head[i] == ">")
            i += 1
        head = head[i:].strip()
    return re.sub(r"\[\[.*?\]\]\s*", "", head)


def throwing(text, cls="", public=True):
    """Returns names that may throw in the text of a namespace or a class."""
    for head, body in statements(text):
        if m := ACCESS.match(head + ":" if head in ("public", "protected", "private") else head):
            public = m[1] == "public"
            continue
        if not public or head.startswith(("using ", "static_assert", "namespace tactor::detail", "typedef ")):
            continue
        if re.match(r"(inline )?namespace\b", head):
            yield from throwing(body)
        elif m := TYPE.match(head):
            if body is not None and m[1] != "enum":
                yield from throwing(body, f"{cls}{m[2]}::", m[1] == "struct")
        elif (m := NAME.search(declared := without_template(head))) and not VALUE.match(declared):
            after = declared[find_end(declared, m.end() - 1) + 1:].split(" : ")[0]
            if not re.search(r"\bnoexcept\b|=\s*(?:delete|default)\b", after) and not m[1].startswith("~"):
                yield cls + m[1].replace(" ", "")


def complaints(declared, rows):
    kinds = {n.removeprefix("from_string<").removesuffix(">") for n in declared if n.startswith("from_string<")}
    for kind in sorted(kinds - set(re.findall(r"\w+", "".join(row for _, row in rows["from_string"])))):
        yield f"from_string<{kind}>: not in the row of from_string"
    for name, times in sorted(declared.items()):
        called = name.split("::")[-1].removeprefix("operator")
        if name.startswith("from_string<") or name in UNTRIED:
            continue
        if (tried := sum(1 for more, _ in rows[name] if not more)) != times:
            yield f"{name}: {times} declared, {tried} tried: tests/engine/exhaustion_*.cpp"
        for more, row in rows[name]:
            if not re.search(rf"(?<!\w){re.escape(called)}(?!\w)", row):
                yield f"{name}{more or ''}: its row does not call it"
    for name in sorted((set(rows) | set(UNTRIED)) - set(declared) - {"from_string"}):
        yield f"{name}: no public header declares it, or it is noexcept"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    declared = collections.Counter()
    for header in sorted((root / "include" / "tactor").glob("*.hpp")):
        declared.update(throwing(KIND.sub(r"\1 from_string<\1>()", IGNORED.sub("", header.read_text(encoding="utf-8")))))
    rows = collections.defaultdict(list)
    for table in sorted((root / "tests" / "engine").glob("exhaustion_*.cpp")):
        parts = ROW.split(table.read_text(encoding="utf-8"))
        for name, more, row in zip(parts[1::3], parts[2::3], parts[3::3]):
            rows[name].append((more, row))
    bad = list(complaints(declared, rows))
    for line in bad:
        print(line)
    print(f"{max(len(declared) - len(bad), 0)} passed, {len(bad)} failed")
    return 1 if bad or not declared else 0


if __name__ == "__main__":
    sys.exit(main())
