# SPDX-License-Identifier: MIT
"""Runs the tests of the pages' modules, *.test.mjs in this folder, by the test runner of Node.js. Usage: test_modules.py [PATTERN]"""
import pathlib
import re
import shutil
import subprocess
import sys

CASE = re.compile(r"^(not )?ok \d+ - (.*?)(?: # ((?:SKIP|TODO).*))?$", re.M)


def main():
    node = shutil.which("node")
    if node is None:
        print("SKIPPED: the pages' modules: Node.js is not there (install nodejs)\n0 passed, 0 failed, 1 skipped")
        return 0
    passed = failed = skipped = 0
    for file in sorted(pathlib.Path(__file__).parent.glob(f"{(sys.argv[1:] or '*')[0]}.test.mjs")):
        # Does not use `node --test`, which in some versions counts files as cases, too.
        result = subprocess.run([node, "--test-reporter=tap", file], capture_output=True, text=True, check=False)
        bad = []
        for failure, name, why in CASE.findall(result.stdout):
            if failure:
                bad.append(name)
            elif why:
                skipped += 1
                print(f"SKIPPED: {file.name}: {name}: {why}")
            else:
                passed += 1
        if result.returncode and not bad:
            bad.append(f"ends with status {result.returncode}")
        if bad:
            print(result.stdout, result.stderr, *(f"FAIL: {file.name}: {name}" for name in bad), sep="\n")
        failed += len(bad)
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
