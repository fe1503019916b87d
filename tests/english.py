# SPDX-License-Identifier: MIT
"""Checks the language of comments, names and pages.

Usage: english.py SOURCE_ROOT. Comments of functions begin with a verb, those of types and variables with a noun; functions are called by verbs or
nouns, not ..._of; README, guide and the other pages have at most 100 columns and no sentence of 30 words or more.
"""
import pathlib
import re
import sys

COMMENT = re.compile(r"^\s*(?:///|//|#)\s+(What|Whether|How|Those|One|Of|Where|Which|Who|Why|Nothing|As|All)\s")
NAME = re.compile(r"\b([a-z]\w*_of)\s*\(")
# Names of the standard library and of its style.
TERMS = ("as_of", "one_of", "first_of", "last_of", "not_of", "any_of", "all_of", "none_of")
COLUMNS, WORDS = 100, 30


def bad_code(file, text):
    for number, line in enumerate(text.split("\n"), 1):
        if COMMENT.match(line):
            yield f"{file}:{number}: begin the comment with a verb or a noun: {line.strip()[:80]}"
        for name in NAME.findall(line):
            if not name.endswith(TERMS):
                yield f"{file}:{number}: {name}: name it by a verb or a noun"


def bad_page(file, text):
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > COLUMNS and not line.startswith(("|", "![")):
            yield f"{file}:{number}: {len(line)} columns"
    # Without code, tables and headings.
    prose = re.sub(r"`[^`]*`", "x", re.sub(r"(?m)^( {4}.*|\|.*|#.*)$", "", text))
    for block in re.split(r"\n\s*\n|\n(?=\s*(?:\*|\d+\.) )", prose):
        for sentence in re.split(r"(?<=[.!?:])\s+", block):
            if len(sentence.split()) >= WORDS:
                yield f"{file}: {len(sentence.split())} words in a sentence: {' '.join(sentence.split())[:80]}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    code = [f for folder in ("src", "include", "tests", "examples") for f in sorted((root / folder).rglob("*")) if f.suffix in (".cpp", ".hpp", ".py")]
    pages = [*sorted(root.glob("*.md")), *sorted((root / "man/guide").glob("*.md")), *sorted((root / "tests").rglob("*.md")), *sorted((root / "examples").rglob("*.md"))]
    bad = [b for files, check in ((code, bad_code), (pages, bad_page)) for f in files for b in check(f.relative_to(root), f.read_text(encoding="utf-8"))]
    print(*bad, sep="\n")
    failed = len({b.split(":")[0] for b in bad})
    print(f"{len(code) + len(pages) - failed} passed, {failed} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
