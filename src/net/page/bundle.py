#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Joins a page, its styles and its modules into one document, by esbuild. Usage: bundle.py ESBUILD PAGE.html OUTPUT [DEPFILE]

An output whose name ends in .inc is a C++ initialiser of a page_document: the page, what its Content-Security-Policy says of its script and style,
and the page compressed. Lines of the page that are only
    <link rel="stylesheet" href="FILE.css">  and  <script src="FILE.js">...</script>
become the files' contents, with what those import."""
import base64
import gzip
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import tempfile

STYLE = re.compile(r'\s*<link rel="stylesheet" href="([\w./-]+)">\s*')
SCRIPT = re.compile(r'\s*<script(?: type="module")? src="([\w./-]+)"></script>\s*')


class Bundle:
    def __init__(self, esbuild, page):
        self.esbuild = esbuild
        self.read = [page]
        self.text = "".join(self.line(line) for line in page.read_text(encoding="utf-8").splitlines()).replace("</style>\n<style>\n", "")

    def line(self, line):
        if m := STYLE.fullmatch(line):
            return f"<style>\n{self.joined(m[1])}</style>\n"
        if m := SCRIPT.fullmatch(line):
            return f'<script>\n"use strict";\n{self.joined(m[1])}</script>\n'
        return re.sub(r'="([\w-]+)"(?!/)', r"=\1", line.strip()) + "\n"  # r=8/> would be 8/

    def joined(self, name):
        """Returns a style or a module with all that it imports."""
        file = self.read[0].parent / name
        with tempfile.TemporaryDirectory() as folder:
            out, about = pathlib.Path(folder) / "out", pathlib.Path(folder) / "about"
            done = subprocess.run([self.esbuild, "--bundle", "--minify", "--charset=utf8", "--log-level=warning", f"--outfile={out}", f"--metafile={about}",
                                   str(file)], stderr=subprocess.PIPE, text=True, check=False)
            if done.stderr or done.returncode:  # a warning, too
                sys.exit(done.stderr)
            self.read += map(pathlib.Path, json.loads(about.read_text(encoding="utf-8"))["inputs"])
            return out.read_text(encoding="utf-8")


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


def main(esbuild, page, output, depfile=None):
    b = Bundle(esbuild, pathlib.Path(page))
    text = b.text
    if output.endswith(".inc"):
        if ')page"' in text:
            sys.exit(f'{page}: )page" would end the literal')
        text = initialiser(text)
    pathlib.Path(output).write_text(text, encoding="utf-8")
    if depfile:
        pathlib.Path(depfile).write_text(f"{output}: {' '.join(map(str, b.read))}\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
