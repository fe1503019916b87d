# SPDX-License-Identifier: MIT
"""Pages of the C++ interface, a page for each public header, from Doxygen's XML by breathe."""
import collections
import pathlib
import re
import xml.etree.ElementTree as xml

def drop_initializers(folder):
    """Removes default values that name members ({.algorithm = ...}): Sphinx cannot read these."""
    for file in folder.glob("*.xml"):
        text = file.read_text(encoding="utf-8")
        plain = re.sub(r"<initializer>=?\s*\{\..*?</initializer>", "", text, flags=re.S)
        if plain != text:
            file.write_text(plain, encoding="utf-8")


def list_members(folder):
    """Maps each header to its members in order: (line, kind, name, arguments). Members of classes come with their class."""
    space = xml.parse(folder / "namespacetactor.xml").getroot()[0]
    found = collections.defaultdict(list)

    def add(element, name, arguments=""):
        place = element.find("location")
        found[pathlib.Path(place.get("file")).name].append((int(place.get("line")), element.get("kind"), name, arguments))

    for member in space.iter("memberdef"):
        if not re.match(r"operator|.*<", member.findtext("name")):  # all_values<...> stands once for all
            add(member, f"tactor::{member.findtext('name')}", re.sub(r" noexcept|\s*=\s*(delete|default)", "", member.findtext("argsstring") or ""))
    for inner in space.findall("innerclass"):
        if inner.text.count("::") == 1:
            add(xml.parse(folder / f"{inner.get('refid')}.xml").getroot()[0], inner.text)
    return found


def describe_header(folder, header):
    """Returns the paragraphs of a header's own comment."""
    file = xml.parse(folder / f"{header.replace('_', '__').replace('.hpp', '_8hpp')}.xml").getroot()[0]
    return [" ".join("".join(p.itertext()).split()) for part in ("briefdescription", "detaileddescription") for p in file.find(part)]


def write_pages(folder, stage):
    """Writes a page for each header into `stage`; returns their names without suffix. `folder`: Doxygen's XML."""
    drop_initializers(folder)
    names = []
    for header, members in sorted(list_members(folder).items()):
        text = [f"tactor/{header}", "=" * 60, "", *(line for p in describe_header(folder, header) for line in (p.replace("\\", "\\\\").replace("*", "\\*").replace("`", "\\`"), ""))]
        for _, kind, name, arguments in sorted(members):
            text += [f".. doxygen{kind}:: {name}{arguments}", *(["   :members:"] if kind in ("struct", "class") else []), ""]
        names.append(f"cpp-{header.removesuffix('.hpp')}")
        (stage / f"{names[-1]}.rst").write_text("\n".join(text), encoding="utf-8")
    return names
