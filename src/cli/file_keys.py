# SPDX-License-Identifier: MIT
"""Writes the rows of src/cli/file_keys.cpp: the keys of files, as two pages of the manual explain them.

python3 file_keys.py OUTPUT TACTOR.TOML.5 TACTOR-EXPERIMENT.5
"""
import json
import pathlib
import re
import shlex
import sys

PUNCTUATION = set(".,;:)")


def plain(text):
    """Returns a text of a table without the escapes of roff."""
    for escape, sign in (("\\-", "-"), ("\\(dq", '"'), ("\\&", ""), ("\\fB", ""), ("\\fR", "")):
        text = text.replace(escape, sign)
    return text


def joined(words):
    text = ""
    for word in words:
        text += word if not text or text.endswith("(") or word in PUNCTUATION else " " + word
    return text


def macro(line):
    """Returns the words of a line of mdoc that begins with a macro."""
    out, flag, wrap, glue = [], False, None, False
    for token in shlex.split(line[1:].replace("\\&", "").replace("\\(dq", '\\"').replace("'", "\\'")):
        token = plain(token)
        if token in ("Cm", "Ar", "Pa", "Ev", "Ic", "Li", "Sx", "No", "Fl", "Xr", "Ql"):
            flag = token == "Fl"
        elif token == "Ns":
            glue = True
        elif token == "Qo":
            out.append('"')
            glue = True
        elif token == "Qc":
            out[-1] += '"'
        elif token in ("Po", "Pc"):
            out.append("(" if token == "Po" else ")")
        elif token in ("Pq", "Dq"):
            wrap = "()" if token == "Pq" else '""'
            out.append(wrap[0])
        elif token in PUNCTUATION:
            if wrap:
                out[-1] += wrap[1]
                wrap = None
            out.append(token)
        else:
            word = ("-" if flag else "") + token
            glue = glue or bool(out) and out[-1] in ("(", '"') and wrap is not None
            if glue:
                out[-1] += word
            else:
                out.append(word)
            glue = False
    if wrap:
        out[-1] += wrap[1]
    text = joined(out)
    return re.sub(r"\b(tactor[\w.-]*) (\d)\b", r"\1(\2)", text) if line.startswith(".Xr") else text


def prose(lines):
    return joined(" ".join(macro(line) if line.startswith(".") else plain(line) for line in lines).split())


def table_rows(page):
    """Yields table, key, range, default and text of each row of the page's tables."""
    for body in re.findall(r"^\.TS\n[^\n]*\n[^\n]*\.\n(.*?)^\.TE", page, re.M | re.S):
        lines = re.sub(r"T\{\n(.*?)\nT\}", lambda m: m[1].replace("\n", " "), body, flags=re.S).splitlines()
        table, *columns = lines[0].split("\t")
        for line in lines[1:]:
            key, *cells = line.split("\t")
            facts = dict(zip(columns, cells))
            text = facts.pop("meaning", facts.pop("values", ""))
            span = " ".join(filter(None, (facts.get("range"), facts.get("unit"))))
            yield table, key, plain(span), plain(facts.get("default", "")), text


def list_rows(page):
    """Yields the same for the page's lists, whose texts contain the ranges and defaults."""
    table = ""
    seen = ""
    for part in re.split(r"^(?=\.(?:Bl|It|El|Ss|Sh)\b)", page, flags=re.M):
        head, *lines = part.splitlines()
        if head.startswith(".Bl"):
            table = seen or table
        elif head.startswith((".Ss", ".Sh")):
            seen = ""
        elif head.startswith(".It Cm") and table:
            yield table, head.removeprefix(".It Cm "), "", "", "\n".join(lines)
        tables = re.findall(r"^\.Cm (\[+[a-z.]+\]+)", "\n".join(lines), re.M)
        if not head.startswith(".It") or re.match(r"\.It Cm item$", head):
            seen = tables[-1] if tables else seen


def mentioned(text):
    """Returns the words of a manual's text that its macros and fonts mark as keys."""
    words = re.findall(r"\\fB([a-z_]+)\\fR", text) + re.findall(r"([a-z_]+) =", " ".join(re.findall(r"\\fB(.*?)\\fR", text))) + [w for line in re.findall(r"^\.Cm (.*)$", text, re.M) for w in re.findall(r"[a-z_]{2,}", line)]
    return " ".join(dict.fromkeys(words))


def main():
    output, *pages = map(pathlib.Path, sys.argv[1:])
    rows = []
    for page in pages:
        text = page.read_text(encoding="utf-8")
        name = re.sub(r"\.(\d)$", r"(\1)", page.name)
        for table, keys, span, default, meaning in (*table_rows(text), *list_rows(text.partition("\n.Sh EXAMPLES")[0])):
            if not table.startswith("["):
                continue
            said = prose(meaning.splitlines())
            for key in re.split(r" ?, ", keys):
                rows.append((table, key, name, span, default, said, mentioned(meaning)))
    output.write_text("".join(f"{{{', '.join(json.dumps(cell) for cell in row)}}},\n" for row in rows), encoding="utf-8")


if __name__ == "__main__":
    main()
