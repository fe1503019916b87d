# SPDX-License-Identifier: MIT
"""Writes what the fuzzers start from: the examples, and the texts in the readers' own tests.

Usage: seeds.py SOURCE_ROOT FOLDER. Makes FOLDER/TARGET/... for each fuzzer of a reader.
"""
import hashlib
import pathlib
import re
import sys

# Target: files that are seeds whole; tests whose string literals are.
SOURCES = {
    "array_toml": (["examples/arrays/*.toml"], ["test_setup_array.cpp", "test_setup.cpp"]),
    "config_toml": (["examples/tactor.toml"], ["test_setup.cpp", "test_setup_file.cpp"]),
    "stroke_toml": (["examples/strokes/*.toml"], ["test_stroke_toml.cpp"]),
    "stroke_csv": (["examples/strokes/*.csv"], ["test_stroke_csv.cpp"]),
    "stroke_svg": (["examples/strokes/*.svg"], ["test_stroke_svg.cpp", "test_stroke_svg_errors.cpp"]),
    "path_data": ([], ["test_path_svg.cpp", "test_path.cpp", "test_path_length.cpp", "test_path_meets.cpp"]),
    "pcm_name": ([], ["../engine/test_pcm_names.cpp"]),
}
RAW = r'R"(\w*)\((.*?)\)\1"'
PLAIN = r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*'
LITERAL = re.compile(f"{RAW}|({PLAIN})", re.S)


def literals(text):
    code = re.sub(r"^\s*#\s*include.*$|TEST_CASE\([^\n]*", "", text, flags=re.M)
    for match in LITERAL.finditer(code):
        if match[3]:
            yield "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', match[3])).encode().decode("unicode_escape").encode("latin-1")
        else:
            yield match[2].encode()


def seeds(root, target):
    whole, tests = SOURCES[target]
    for pattern in whole:
        yield from (f.read_bytes() for f in sorted(root.glob(pattern)))
    for name in tests:
        yield from (s for s in literals((root / "tests/model" / name).read_text(encoding="utf-8")) if len(s) > 3)


def main():
    root, folder = (pathlib.Path(a) for a in sys.argv[1:])
    for target in SOURCES:
        place = folder / target
        place.mkdir(parents=True, exist_ok=True)
        count = 0
        for count, seed in enumerate(seeds(root, target), 1):
            (place / hashlib.sha1(seed).hexdigest()).write_bytes(seed)
        if count < 10:
            sys.exit(f"seeds.py: only {count} seeds for {target}: have the tests moved?")


if __name__ == "__main__":
    main()
