#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Joins a page, its styles and its modules into one document. Usage: bundle.py PAGE.html OUTPUT [DEPFILE [ESBUILD]]

With esbuild, styles and modules are made smaller. Without it the page does the same, and is half as long again.

An output whose name ends in .inc is a C++ initialiser of a page_document: the page, what its Content-Security-Policy says of its script and style,
and the page compressed. Lines of the page that are only
    <link rel="stylesheet" href="FILE.css">  and  <script src="FILE.js">...</script>
become the files' contents. A module imports by lines such as
    import {name, other} from "./FILE.js";   or   import "./FILE.js";
and exports declarations. Names at the top of modules are unique in the page, so that modules can be joined as they are.
Blank lines and lines that are only a comment are left out."""
import base64
import gzip
import hashlib
import pathlib
import re
import subprocess
import sys

STYLE = re.compile(r'\s*<link rel="stylesheet" href="([\w./-]+)">\s*')
SCRIPT = re.compile(r'\s*<script(?: type="module")? src="([\w./-]+)"></script>\s*')
IMPORT = re.compile(r'import (?:\{([\w, ]+)\} from )?"([\w./-]+)";')
DECLARATION = re.compile(r"(export )?(?:async )?(?:function\*?|const|let|class) (\w+)")


class Bundle:
    def __init__(self, esbuild=None):
        self.esbuild = esbuild
        self.read = []       # files, in the order in which they were read
        self.exported = {}   # file: names
        self.declared = {}   # name: place

    def text(self, file):
        self.read.append(file)
        return file.read_text(encoding="utf-8")

    def page(self, file):
        text = "".join(self.line(file.parent, line) for line in self.text(file).splitlines(keepends=True))
        return text.replace("</style>\n<style>\n", "")

    def line(self, folder, line):
        if m := STYLE.fullmatch(line):
            return f'<style>\n{self.smaller(folder / m[1], self.style(folder / m[1]))}</style>\n'
        if m := SCRIPT.fullmatch(line):
            file = (folder / m[1]).resolve()
            return f'<script>\n"use strict";\n{self.smaller(file, self.module(file))}</script>\n'
        return re.sub(r'="([\w-]+)"', r"=\1", line.strip()) + "\n" if self.esbuild else line

    def smaller(self, file, joined):
        """Returns what esbuild makes of a file, or the joined text without it."""
        if not self.esbuild:
            return joined
        return subprocess.run([self.esbuild, "--bundle", "--minify", "--charset=utf8", "--log-level=error", str(file)], check=True, capture_output=True,
                              text=True).stdout

    def style(self, file):
        return "".join(f"{line.strip()}\n" for line in self.text(file).splitlines()
                       if line.strip() and not re.fullmatch(r"\s*/\*.*\*/\s*", line))

    def module(self, file):
        """Returns a module after all those that it imports and that were not returned before."""
        if file in self.exported:
            return ""
        self.exported[file] = set()
        before, own = [], []
        for number, line in enumerate(self.text(file).splitlines(), 1):
            place = f"{file}:{number}"
            if line.startswith("import "):
                before.append(self.imported(file, line, place))
                continue
            if m := DECLARATION.match(line):
                self.declare(m[2], place)
                if m[1]:
                    self.exported[file].add(m[2])
                    line = line[len(m[1]):]
            elif line.startswith("export "):
                sys.exit(f"{place}: export a declaration")
            if line.strip() and not line.lstrip().startswith("//"):
                own.append(line + "\n")
        return "".join(before + own)

    def imported(self, file, line, place):
        m = IMPORT.fullmatch(line)
        if not m:
            sys.exit(f'{place}: write import {{name}} from "./file.js"; on one line')
        other = (file.parent / m[2]).resolve()
        text = self.module(other)
        if missing := {n.strip() for n in (m[1] or "").split(",") if n.strip()} - self.exported[other]:
            sys.exit(f"{place}: {m[2]} does not export {', '.join(sorted(missing))}")
        return text

    def declare(self, name, place):
        if name in self.declared:
            sys.exit(f"{place}: {name} stands at {self.declared[name]}, too")
        self.declared[name] = place


def policy(text):
    """Returns the sources of script and style: the hashes of what the page has."""
    def allowed(kind):
        found = re.findall(rf"<{kind}>(.*?)</{kind}>", text, re.DOTALL)
        return " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(t.encode()).digest()).decode()}'" for t in found) or "'none'"
    return f"script-src {allowed('script')}; style-src {allowed('style')}"


def initialiser(text):
    """Returns a page_document of C++: the text, its policy, and the text compressed."""
    smaller = gzip.compress(text.encode(), mtime=0)
    lines = ["".join(f"\\{b:03o}" for b in smaller[at:at + 32]) for at in range(0, len(smaller), 32)]
    return (f'{{R"page({text})page",\n"{policy(text)}",\n{{' + "\n".join(f'"{line}"' for line in lines) + f",\n{len(smaller)}}}}}\n")


def main(page, output, depfile=None, esbuild=None):
    b = Bundle(esbuild)
    text = b.page(pathlib.Path(page))
    if output.endswith(".inc"):
        if ')page"' in text:
            sys.exit(f'{page}: )page" would end the literal')
        text = initialiser(text)
    pathlib.Path(output).write_text(text, encoding="utf-8")
    if depfile:
        pathlib.Path(depfile).write_text(f"{output}: {' '.join(map(str, b.read))}\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
