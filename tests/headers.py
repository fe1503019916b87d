# SPDX-License-Identifier: MIT
"""Holds the public headers to their conventions, since what is awkward there becomes ABI.

* Times are seconds as double, called ..._s; instants of a clock are ns as int64, called ..._ns. No ..._ms. Only where a
  call could take one for the other, in player.hpp, they are std::chrono's.
* Closed sets are enumerations called ..._kind, each with TACTOR_KIND, which declares to_string(), from_string() and
  all_values(), from name to value and back in tests/engine/test_values.cpp.
* Nothing is made from an impl in public, and nobody gets at one: no public data().
* Classes with virtual functions cannot be copied.
* A function that has a result is [[nodiscard]]: to drop it is a mistake (to_string() and its kin apart; write_wav(), whose
  work is the file). So are members that are const or static, for they do nothing else, and virtual ones: what a device
  answers is not dropped.
* What is exported is in the inline namespace of this version: v0 of 0.1, v0_N of a 0.N that breaks programs.

Usage: headers.py SOURCE_ROOT. Prints each line that breaks a rule, then counts.
"""
import pathlib
import re
import sys

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
ENUM = re.compile(r"\benum\s+class\s+(\w+)")
# A double that is a time by its name, without a unit.
TIME = re.compile(r"\bdouble\s+(duration|timeout|delay|onset|start|time|pause|wait|window|period|seconds)\b(?!_)")
INT_TIME = re.compile(r"\b(?:std::)?u?int\d+_t\s+\w*_(?:s|ms|us)\b")
DROPPED = re.compile(r"^TACTOR_API\s+(?!void\b)[^;{]*?\b(\w+)\(", re.M)
MAY_DROP = {"to_string", "write_wav"}
MEMBER = re.compile(r"^    ((?:(?:static|constexpr|virtual) )*)(?!void |friend |using |return |explicit )"
                    r"(?:const )?[\w:]+(?:<[^;{}()]*>)?[&* ]+(?!operator)(\w+)\(([^;{]*)", re.M)
CLASS = re.compile(r"\bclass\s+(?:TACTOR_API\s+)?(\w+)(?:\s+final)?[^;{]*\{(.*?)\n\};", re.S)


def public_part(body):
    """Returns the public part of a class's text."""
    kept, public = [], False
    for line in body.split("\n"):
        if m := re.match(r"\s*(public|protected|private):", line):
            public = m[1] == "public"
        elif public:
            kept.append(line)
    return "\n".join(kept)


def complaints(name, text, everything, tried):
    code = COMMENT.sub("", text)
    if "chrono" in code and name != "player.hpp":
        yield f"{name}: chrono; times are seconds as double"
    for m in re.findall(r"\b\w+_ms\b", code):
        yield f"{name}: {m}: times are seconds (_s), clock instants ns (_ns)"
    for m in TIME.finditer(code):
        yield f"{name}: {m[0]}: a time in seconds is called ..._s"
    for m in INT_TIME.finditer(code):
        yield f"{name}: {m[0]}: whole numbers of time are ns"
    for enum in ENUM.findall(code):
        if not enum.endswith("_kind"):
            yield f"{name}: enumeration {enum} is not called ..._kind"
        if f"\nTACTOR_KIND({enum});\n" not in code:
            yield f"{name}: {enum} has no TACTOR_KIND({enum})"
        if enum not in tried:
            yield f"{name}: tests/engine/test_values.cpp does not try {enum}"
    for opened in re.findall(r"^namespace [^{]*\{\n[^\n]*", code, re.M):
        if not re.match(r"namespace tactor(::detail \{| \{\ninline namespace v0 \{)", opened):
            yield f"{name}: {opened}: what is exported is in the inline namespace v0"
    for part in re.split(r"^namespace ", code, flags=re.M):
        if part.startswith("tactor::detail {"):
            for m in re.finditer(r"TACTOR_API\b[^;{]*", part):
                yield f"{name}: {m[0]}: what is exported is in the inline namespace v0"
    if re.search(r"\benum\s+(?!class)\w+\s*\{", code):
        yield f"{name}: an enumeration without class"
    for m in DROPPED.finditer(code):
        before = code[: m.start()].rstrip()
        if m[1] not in MAY_DROP and not before.endswith("template <>"):
            yield f"{name}: {m[1]}() is not [[nodiscard]]"
    for m in MEMBER.finditer(code):
        only_asks = "static " in m[1] or "virtual " in m[1] or re.search(r"\)\s*const\b", m[0])
        if only_asks and not re.search(r"=\s*delete", m[0]):
            yield f"{name}: {m[2]}() is not [[nodiscard]]"
    for cls, body in CLASS.findall(code):
        seen = public_part(body)
        if re.search(r"\bdata\(\)", seen):
            yield f"{name}: {cls}::data() is public"
        if re.search(rf"\b{cls}\(\s*std::(?:shared|unique)_ptr<(?:const )?impl>", seen):
            yield f"{name}: {cls} can be made from an impl in public"
        base = re.search(rf"class\s+(?:TACTOR_API\s+)?{cls}\s*(?:final\s*)?:", code)
        if re.search(r"^\s*virtual\s", body, re.M) and not base and f"{cls}(const {cls}&) = delete" not in body:
            yield f"{name}: {cls} has virtual functions and can be copied"


def main():
    root = pathlib.Path(sys.argv[1]).resolve() / "include" / "tactor"
    texts = {f.name: f.read_text(encoding="utf-8") for f in sorted(root.glob("*.hpp"))}
    everything = "\n".join(COMMENT.sub("", t) for t in texts.values())
    tried = set(re.findall(r"\w+_kind", (root.parents[1] / "tests" / "engine" / "test_values.cpp").read_text(encoding="utf-8")))
    bad = {name: list(complaints(name, text, everything, tried)) for name, text in texts.items()}
    for lines in bad.values():
        for line in lines:
            print(line)
    broken = sum(1 for lines in bad.values() if lines)
    print(f"{len(texts) - broken} passed, {broken} failed")
    return 1 if broken or not texts else 0


if __name__ == "__main__":
    sys.exit(main())
