# SPDX-License-Identifier: MIT
"""Checks what the system reads: udev rules, systemd units, limits, packages. Usage: system.py SOURCE_ROOT.

udev and systemd check their own files where they are; the grammar below holds everywhere.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib

MATCH = r"(?:ACTION|KERNEL|KERNELS|SUBSYSTEM|SUBSYSTEMS|ATTR\{[\w/]+\}|ATTRS\{[\w/]+\}|ENV\{\w+\})(?:==|!=)"
ASSIGN = r"(?:GROUP|MODE|GOTO|LABEL|ATTR\{[\w/]+\}|ENV\{\w+\}|SYMLINK|TAG)(?:=|\+=)"
RULE = re.compile(rf'(?:(?:{MATCH}|{ASSIGN})"[^"]*"(?:, |$))+$')
LIMIT = re.compile(r"@\w+\s+-\s+(?:rtprio|memlock)\s+\d+$")


def bad_rules(file):
    gotos, labels = set(), set()
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        # A commented example must be right once its # is off.
        rule = line.removeprefix("#") if re.match(r"#[A-Z]+==", line) else line
        if not rule or rule.startswith("#"):
            continue
        if not RULE.match(rule):
            yield f"{file}:{number}: no udev rule: {rule}"
        if "RUN" in rule or "PROGRAM" in rule:
            yield f"{file}:{number}: runs a program"
        gotos |= set(re.findall(r'GOTO="(\w+)"', rule))
        labels |= set(re.findall(r'LABEL="(\w+)"', rule))
    if gotos - labels:
        yield f"{file}: no label {gotos - labels}"


def said_by(*command, **more):
    r = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | more)
    return [] if r.returncode == 0 else (r.stdout + r.stderr).splitlines() or ["failed"]


def can_verify_rules():
    if shutil.which("udevadm") is None:
        return False
    return "verify" in subprocess.run(["udevadm", "--help"], capture_output=True, text=True, check=False).stdout


def bad_units(folder, *options):
    """Checks all units of a folder, which name one another. The system's must be hardened: exposure 2.0 at most."""
    with tempfile.TemporaryDirectory() as place:
        copies = []
        for file in sorted(f for f in folder.iterdir() if f.suffix in (".service", ".socket")):
            copies.append(pathlib.Path(place) / file.name.replace("@.", "@x."))
            # Neither tool nor man pages are installed here.
            text = re.sub(r"^(Exec\w+)=\S+", r"\1=/bin/true", file.read_text(encoding="utf-8"), flags=re.M)
            copies[-1].write_text(re.sub(r"^Documentation=.*\n", "", text, flags=re.M), encoding="utf-8")
        yield from said_by("systemd-analyze", "verify", *options, *map(str, copies), XDG_RUNTIME_DIR=place)
        for copy in copies:
            if copy.suffix == ".service" and not options:
                yield from said_by("systemd-analyze", "security", "--offline=true", "--threshold=20", str(copy))


def bad_packages(root):
    """Checks that the Debian packages are built with the listed packages for library, tool and Python package, except the
    common ones."""
    lists = dict(line.split(": ", 1) for line in (root / "tests/packages").read_text(encoding="utf-8").splitlines()
                 if not line.startswith("#"))
    wanted = set(" ".join(lists[n] for n in ("library", "tool", "python-build")).split()) - {"dpkg-dev", "g++", "ninja-build", "pkg-config"}
    control = (root / "examples/debian/control").read_text(encoding="utf-8")
    helpers = {"debhelper-compat", "dh-sequence-installsysusers", "dh-sequence-python3", "dh-sequence-sphinxdoc", "pkgconf"}
    for field, packages in (("Build-Depends", wanted), ("Build-Depends-Indep", set(lists["docs"].split()))):
        depends = re.search(rf"^{field}:\n((?: .*\n)+)", control, re.M)[1]
        named = {line.strip().split(" ")[0] for line in depends.replace(",", "").splitlines()} - helpers
        if named != packages:
            yield f"examples/debian/control: {field} differ from tests/packages: {sorted(named ^ packages)}"
    version = re.search(r"^  version: '(.*)'", (root / "meson.build").read_text(encoding="utf-8"), re.M)[1]
    if not (root / "examples/debian/changelog").read_text(encoding="utf-8").startswith(f"tactor ({version}) "):
        yield f"examples/debian/changelog: not {version}, the version in meson.build"
    with open(root / "pyproject.toml", "rb") as f:
        package = tomllib.load(f)["project"]
    if package["version"] != version:
        yield f"pyproject.toml: version {package['version']}, not {version}, the version in meson.build"
    metadata = (root / "src/python/metadata.in").read_text(encoding="utf-8")
    said = [f"Summary: {package['description']}", f"Author: {package['authors'][0]['name']}", "License: MIT", f"Requires-Python: {package['requires-python']}"]
    if metadata.splitlines()[3:] != said + [f"Requires-Dist: {d}" for d in package["dependencies"]]:
        yield "src/python/metadata.in: it says other things than pyproject.toml"
    soname = re.search(r"soversion: '(\d+)'", (root / "src/meson.build").read_text(encoding="utf-8"))[1]
    if f"Package: libtactor{soname}\n" not in control:
        yield f"examples/debian/control: no package libtactor{soname}, the name of the library"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    checks, skipped = [], []
    for rules in sorted((root / "udev").glob("*.rules")):
        checks.append(list(bad_rules(rules)))
        if can_verify_rules():
            checks.append(said_by("udevadm", "verify", "--resolve-names=never", str(rules)))
        else:
            skipped.append("udevadm verify: udev 254 or later is not here")
    limits = (root / "examples/limits.d-tactor.conf").read_text(encoding="utf-8").splitlines()
    checks.append([f"limits: {line}" for line in limits if not line.startswith("#") and not LIMIT.match(line)])
    for folder, options in (("", ()), ("user", ("--user",))):
        if shutil.which("systemd-analyze"):
            checks.append(list(bad_units(root / "examples/systemd" / folder, *options)))
        else:
            skipped.append(f"examples/systemd/{folder}: systemd-analyze is not here")
    checks.append(list(bad_packages(root)))
    for bad in checks:
        print(*bad, sep="\n", end="\n" if bad else "")
    for why in skipped:
        print(f"SKIPPED: {why}")
    failed = sum(bool(bad) for bad in checks)
    print(f"{len(checks) - failed} passed, {failed} failed, {len(skipped)} skipped")
    return 1 if failed or not checks else 0


if __name__ == "__main__":
    sys.exit(main())
