#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the site: the guide, a gallery whose pictures the tool draws, the manuals, JSON Schemas and the C++ reference.

Usage: make_site.py SOURCE_ROOT OUTPUT VERSION TOOL SCHEMAS_FOLDER DOXYGEN DOXYFILE XML_FOLDER

Pages go through Sphinx with MyST and furo, manuals through mandoc, the public headers through Doxygen and breathe. The reference
of the Python package is there if Python can import tactor. Needs no network.
A warning of Sphinx or mandoc, or a link that leads nowhere, is an error, exit status 1.
"""
import html
import importlib.util
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

import cpp_pages

# Presets that the gallery shows beside the files of examples, with their options.
PRESETS = [("park2016-1", ""), ("park2016-2", ""), ("park2016-3", ""), ("park2016-4", ""), ("wave-2x4", "--array palm-2x4"), ("round-2x4", "--array palm-2x4")]
SHAPES = ["line", "circle", "eight", "spiral"]
# How each array of examples is shown.
ON_ARRAY = {"arm-line-4": '--path "M 0 0 L 120 0"', "lra-row-3": '--path "M 0 0 H 60" --sl 12 --carrier 170'}
PYTHON = "python-reference/index"
EXAMPLES = [f"examples/{folder}/README" for folder in ("python", "jspsych", "octave", "psychopy", "systemd")]
SECTIONS = {"Start": ["start", "safety", "studio", "how-to", "study", "worked-study", "drawings", "examples/experiments/README", "runners", "psychportaudio", "files", "content", "cpp", "python", "parts", "machines", "examples/rtp/README", "questions", "trouble", "glossary"],
            "Understand": ["method", "predictions", "performance", "compared", "architecture"],
            "Reference": ["manuals", "cpp-reference", PYTHON, "schemas", "gallery", *EXAMPLES, "CONTRIBUTING", "tests/lanes/README", "SECURITY", "NEWS"]}


def on_the_site(text, root):
    """Rewrites the links of a page to where the site has their targets; a link to a folder becomes its name."""
    def rewritten(link):
        label, target = link[1], link[2].removeprefix("../../").removeprefix("man/guide/")
        if target.startswith("man/") and (root / target).is_file():
            target = f"manual/{target.removeprefix('man/')}.md"
        return f"`{target}`" if (root / target).is_dir() else f"[{label}]({target})"
    return re.sub(r"(?<!!)\[([^\]]+)\]\(([^)#:\s]+)\)", rewritten, re.sub(r"(!\[[^\]]*\]\()\.\./\.\./", r"\1", text))


def with_manuals(text, pages):
    """Links manuals that a text names, as in tactor.toml(5), outside code."""
    def linked(name):
        page = f"{name[1]}.{name[2]}"
        return f"[{name[0]}](manual/{page}.md)" if page in pages else name[0]
    parts = re.split(r"(`[^`]*`|^    .*$|\[[^\]]*\]\([^)]*\))", text, flags=re.M)
    return "".join(part if i % 2 else re.sub(r"\b([a-z][\w.-]*)\((\d)\)", linked, part) for i, part in enumerate(parts))


def find_page(folder, name, section):
    """Returns the page of a manual, or None if there is none."""
    page = folder / f"{name}.{section}"
    return page if page.exists() else None


def list_manuals(folder):
    """The list of manuals by section, each with its description."""
    text = ["# Manuals", ""]
    for section, title in {"1": "Commands", "7": "Options, the service, a Raspberry Pi", "5": "Files", "3": "Library"}.items():
        text += [f"## {title}", ""]
        for page in sorted(folder.glob(f"*.{section}"), key=lambda page: page.stem):
            what = re.search(r"^\.Nd (.*)", page.read_text(encoding="utf-8"), re.M)[1]
            text.append(f"* [{page.stem}({section})](manual/{page.name}.md): {what}")
        text.append("")
    return "\n".join(text)


def manual(page):
    text = subprocess.run(["mandoc", "-Thtml", "-Wwarning,stop", "-Ofragment", page], check=True, capture_output=True, text=True).stdout
    # The page's name is its heading; the lines at the top and the end of a printed page are not needed.
    text = re.sub(r'<table class="(?:head|foot)">.*?</table>', "", text, flags=re.S)
    text = re.sub(r"<(/?)h([12])\b", lambda h: f"<{h[1]}h{int(h[2]) + 1}", text)
    # Links to manuals of the site; other manuals have no address.
    text = re.sub(r'<a class="Xr">(([\w.-]+)\((\d)\))</a>',
                  lambda x: f'<a class="Xr" href="{to.name}.html">{x[1]}</a>' if (to := find_page(page.parent, x[2], x[3])) else x[1], text)
    name, section = page.stem, page.suffix[1:]
    return f"# {name}({section})\n\n```{{raw}} html\n{text}\n```\n"


def first_comment(path):
    """The sentence that a file of examples begins with."""
    words = []
    for line in path.read_text(encoding="utf-8").splitlines()[1:]:
        if not line.startswith("# "):
            break
        words.append(line[2:])
        if re.search(r"[.:]$", line):
            break
    return " ".join(words).rstrip(":") if path.suffix == ".toml" else ""


def gallery(root, stage, tool):
    """The page of the gallery; draws its pictures."""
    (stage / "gallery").mkdir()
    entries = [(f"Preset {name}", "", f"{name} {more}".strip(), None) for name, more in PRESETS]
    entries += [(f"Shape {name}", "As large as the array.", f"--shape {name}", None) for name in SHAPES]
    for path in sorted((root / "examples/strokes").iterdir()):
        if path.suffix in (".toml", ".csv", ".svg"):
            more = " --array palm-2x4" if "2x4" in path.name else " --fit" if path.suffix == ".svg" else ""
            entries.append((f"Stroke {path.stem}", first_comment(path), f"examples/strokes/{path.name}{more}", path))
    for path in sorted((root / "examples/arrays").iterdir()):
        entries.append((f"Array {path.stem}", first_comment(path), f"{ON_ARRAY.get(path.stem, '--shape line')} --array examples/arrays/{path.name}", path))
    text = ["# Gallery", "Each picture is made by the command above it, when this site is built.", ""]
    for title, what, arguments, path in entries:
        picture = title.split()[1] + ".svg"
        command = f"tactor plot {arguments} -o {picture}"
        subprocess.run([tool, "plot", *shlex.split(arguments), "-o", stage / "gallery" / picture], cwd=root, check=True, capture_output=True)
        text += [f"## {title}", "", what, "", f"    {command}", "", f"![{title}](gallery/{picture})", ""]
        if path:
            text += [f"[The file](examples/{path.parent.name}/{path.name})", ""]
    return "\n".join(text)


def stage_pages(root, stage, tool, schemas, reference):
    """Writes what Sphinx reads: all pages, side by side, with pictures and files beside them."""
    shutil.copytree(root / "examples", stage / "examples", ignore=shutil.ignore_patterns("debian"))
    for picture in (root / "man/guide").iterdir():
        if picture.suffix in (".svg", ".png"):
            shutil.copy(picture, stage)
    pages = {page.name for page in (root / "man").glob("*.[1-8]")}
    (stage / "manual").mkdir()
    for page in sorted((root / "man").glob("*.[1-8]")):
        (stage / "manual" / f"{page.name}.md").write_text(manual(page), encoding="utf-8")
    texts = {page.stem: page.read_text(encoding="utf-8") for page in (root / "man/guide").glob("*.md")}
    texts |= {name: (root / f"{name}.md").read_text(encoding="utf-8") for name in ("CONTRIBUTING", "SECURITY", "NEWS")}
    texts["manuals"] = list_manuals(root / "man")
    texts["schemas"] = "# JSON Schemas\n\ntactor-json(5) explains each field.\n\n" + "\n".join(
        f"* [{s.name}](schemas/{s.name})" for s in sorted(schemas.glob("*.json"))) + "\n"
    texts["gallery"] = gallery(root, stage, tool)
    shutil.copytree(schemas, stage / "schemas", ignore=lambda _, names: [n for n in names if not n.endswith(".json")])
    headers = cpp_pages.write_pages(reference, stage)
    texts["cpp-reference"] = "# C++ interface\n\n```{toctree}\n" + "\n".join(headers) + "\n```\n"
    absent = {PYTHON}
    if importlib.util.find_spec("tactor"):
        absent.clear()
        shutil.copytree(root / "src/python/reference", (stage / PYTHON).parent)
    for title, names in SECTIONS.items():
        texts["index"] += "\n```{toctree}\n:hidden:\n:caption: " + title + "\n\n" + "\n".join(n for n in names if n not in absent) + "\n```\n"
    for name, text in texts.items():
        (stage / f"{name}.md").write_text(with_manuals(on_the_site(text, root), pages), encoding="utf-8")
    lanes = stage / "tests/lanes"
    lanes.mkdir(parents=True)
    shutil.copy(root / "tests/lanes/README.md", lanes)
    (stage / "manuals.md").open("a").write("\n```{toctree}\n:hidden:\n:glob:\n\nmanual/*\n```\n")


def broken_links(site):
    """Links of the site's pages that lead nowhere within it."""
    bad = []
    for page in site.rglob("*.html"):
        for link in re.findall(r'(?:href|src)="([^"#?]+)', page.read_text(encoding="utf-8")):
            link = html.unescape(link)
            if not re.match(r"[a-z]+:", link) and not (page.parent / link).exists():
                bad.append(f"{page.relative_to(site)}: {link}")
    return bad


def main():
    root, out, schemas = (pathlib.Path(sys.argv[i]).resolve() for i in (1, 2, 5))
    version, tool = sys.argv[3], pathlib.Path(sys.argv[4]).resolve()
    shutil.rmtree(sys.argv[8], ignore_errors=True)
    subprocess.run(sys.argv[6:8], check=True)
    stage = out / "pages"
    shutil.rmtree(out, ignore_errors=True)
    stage.mkdir(parents=True)
    stage_pages(root, stage, tool, schemas, pathlib.Path(sys.argv[8]))
    shutil.copy(root / "man/site/conf.py", stage)
    made = subprocess.run(["sphinx-build", "-W", "--keep-going", "-q", "-b", "html", stage, out / "html"], check=False, env=os.environ | {"TACTOR_VERSION": version, "TACTOR_XML": str(pathlib.Path(sys.argv[8]).resolve())})
    bad = broken_links(out / "html") if made.returncode == 0 else ["sphinx-build found faults, see above"]
    print(*bad, sep="\n")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
