# SPDX-License-Identifier: MIT
"""The script that joins pages, and the pages that it makes. Usage: test_bundle.py BUNDLE SOURCE_ROOT PAGE..."""
import gzip
import html.parser
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

PAGES = [pathlib.Path(p) for p in sys.argv[3:]]
del sys.argv[3:]
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from harness import ROOT, TOOL, ToolTest, main  # noqa: E402

LARGEST = 190_000  # bytes of a page
# An address with a host, other than the names of XML's languages, and what asks for another file.
ELSEWHERE = re.compile(r"\b(?:https?|wss?|ftp)://(?!www\.w3\.org/)[\w\[.-]+|(?:src|href|url)\W{1,3}//[\w.-]+|@import|^import\b.*|\bimport\(.*", re.M)
# Code for which a policy would have to allow 'unsafe-inline' or 'unsafe-eval', in markup that a script makes, too.
UNSAFE = re.compile(r"""<\w[^<>]*\s(?:style|on\w+)=["'$\\]|setAttribute\(["'](?:style|on\w+)["']|\beval\(|\bnew Function\(""")
EXPORTED = r"^export (?:async )?(?:function\*?|const|let|class) (\w+)"
NODE = shutil.which("node")
ESBUILD = shutil.which("esbuild")


class Joining(ToolTest):
    def bundle(self, output="out.html", **files):
        """Writes files (page_html is page.html) and bundles page.html; returns what became of the process."""
        for name, text in files.items():
            base, _, kind = name.rpartition("_")
            self.write(f"{base}.{kind}", text)
        return subprocess.run([sys.executable, TOOL, ESBUILD, "page.html", output, "out.d"], cwd=self.dir, capture_output=True, text=True, check=False)

    def refused(self, why, output="out.html", **files):
        result = self.bundle(output, **{"page_html": '<script src="main.js"></script>\n'} | files)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, why)
        self.assertFalse((self.dir / output).exists())

    def test_a_page_with_its_style_and_modules(self):
        page = '<!DOCTYPE html>\n  <link rel="stylesheet" href="a.css">\n<p id="one">text</p><hr id="two"/>\n<script type="module" src="main.js"></script>\n</html>\n'
        result = self.bundle(page_html=page, a_css="/* a comment */\np {\n  color: red; }\n\n",
                             main_js='import {twice} from "./b.js";\nconst NUMBER = 3;\nlog(twice(NUMBER));\n',
                             b_js="const NUMBER = 2;\nexport function twice(x) {\n  return NUMBER * x;\n}\n")
        self.assertEqual(result.returncode, 0, result.stderr)
        text = (self.dir / "out.html").read_text(encoding="utf-8")
        self.assertRegex(text, r'(?s)^<!DOCTYPE html>\n<style>\np\{color:red\}\n</style>\n<p id=one>text</p><hr id="two"/>\n<script>\n"use strict";\n.*log\(.*</script>\n</html>\n$')
        self.assertEqual((self.dir / "out.d").read_text(encoding="utf-8").split(":")[0], "out.html")
        self.assertEqual({pathlib.Path(f).name for f in (self.dir / "out.d").read_text(encoding="utf-8").split(":", 1)[1].split()},
                         {"page.html", "a.css", "main.js", "b.js"})

    def test_what_is_not_there_is_refused(self):
        main_js = 'import {a} from "./a.js";\nlog(a);\n'
        self.refused("Could not resolve \"./a.js\"", main_js=main_js)
        self.refused('Import "a" will always be undefined', main_js=main_js, a_js="const a = 1;\n")
        self.refused('No matching export in "a.js" for import "a"', main_js=main_js, a_js="export const b = 1;\n")

    def test_a_literal_of_c_plus_plus(self):
        self.assertEqual(self.bundle(page_html="<p>x</p>\n", output="out.inc").returncode, 0)
        written = (self.dir / "out.inc").read_text(encoding="utf-8")
        text, policy, octal = re.fullmatch(r'\{R"page\((.*?)\)page",\n"(.*?)",\n\{(.*),\n\d+\}\}\n', written, re.DOTALL).groups()
        self.assertEqual(text, "<p>x</p>\n")
        self.assertEqual(policy, "script-src 'none'; style-src 'none'")
        self.assertEqual(gzip.decompress(bytes(int(o, 8) for o in re.findall(r"\\(\d{3})", octal))), text.encode())
        self.refused(r'page\.html: \)page" would end the literal', output="end.inc", main_js="f(')page\"');\n")


class Elements(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.all = []  # [name, attributes, text]
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.all.append([tag, dict(attributes), ""])

    def handle_data(self, data):
        if self.all:
            self.all[-1][2] += data


class Modules(ToolTest):
    def test_a_module_imports_what_it_uses_and_no_more(self):
        """Holds that a module imports all that it uses: a missing name shows only when it runs."""
        files = {f: f.read_text(encoding="utf-8") for f in ROOT.glob("src/**/page/**/*.js")}
        exported = {name for text in files.values() for name in re.findall(EXPORTED, text, re.M)}
        self.assertGreater(len(exported), 100)
        for file, text in files.items():
            imported = {name.strip() for names in re.findall(r"^import \{(.*?)\} from", text, re.M) for name in names.split(",")}
            # Without comments, patterns and texts, those between the values of templates, too.
            code = re.sub(r"^import .*$|//.*$|(?<=[:=] )/[^/\n]+/[a-z]*(?=[,;.])|\"(?:[^\"\\\n]|\\.)*\"|(?<=[`}])[ \w,.%“”-]+(?=[`$])", "", text, flags=re.M)
            used = {name for name in exported if re.search(rf"(?:(?<=\.\.\.)|(?<![\w.$])){name}\b(?!\s*:)", code)}
            self.assertEqual(imported - used, set(), f"{file} imports what it does not use")
            # A name of a module's own, or of a function's, is another one.
            own = {name for name in used if re.search(rf"(?:const|let|var|function\*?|class|[(,{{\[])\s*{name}\b\s*(?:[=,;)}}\](]|of\b)|\b{name} =>", code)}
            self.assertEqual(used - imported - own, set(), f"{file} uses what it does not import")


class Pages(ToolTest):
    """Pages as they are served: small, complete, and without what their policy would have to allow."""

    def look(self, at):
        """Calls `at` with each page's text and elements."""
        self.assertTrue(PAGES)
        for file in PAGES:
            with self.subTest(file.name):
                text = re.search(r'R"page\((.*)\)page"', file.read_text(encoding="utf-8"), re.S)[1]
                at(text, Elements(text).all)

    def test_a_page_is_small(self):
        self.look(lambda text, _: self.assertLessEqual(len(text.encode()), LARGEST))

    def test_nothing_comes_from_elsewhere(self):
        def at(text, elements):
            self.assertEqual([found[:80] for found in ELSEWHERE.findall(text)], [])
            for tag, attributes, _ in elements:
                for name in ("src", "href", "srcset", "action", "data", "poster"):
                    self.assertRegex(attributes.get(name, "#"), "^(#|data:)", tag)
        self.look(at)

    def test_nothing_that_runs_stands_in_attributes(self):
        def at(_, elements):
            for tag, attributes, body in elements:
                if tag in ("style", "script"):
                    self.assertEqual(attributes, {})
                self.assertEqual([a for a in attributes if a == "style" or a.startswith("on")], [], (tag, attributes))
                if tag == "script":
                    self.assertEqual([found[:80] for found in UNSAFE.findall(body)], [])
        self.look(at)

    @unittest.skipIf(NODE is None, "Node.js is not there (install nodejs)")
    def test_scripts_parse(self):
        def at(_, elements):
            code = "".join(body for tag, _, body in elements if tag == "script")
            self.assertTrue(code)
            result = subprocess.run([NODE, "--check", self.write("page.cjs", code)], capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.look(at)


if __name__ == "__main__":
    main()
