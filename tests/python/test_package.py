# SPDX-License-Identifier: MIT
"""The installed package, its documentation, types and costs."""
import graphlib
import importlib.metadata
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys

import pytest

import tactor

pytestmark = pytest.mark.unsanitized
FOLDER = pathlib.Path(tactor.__file__).parent


def public_things():
    for name in tactor.__all__:
        thing = getattr(tactor, name)
        assert name in dir(tactor)
        yield name, thing
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, (classmethod, property))):
                    yield f"{name}.{member}", value.__func__ if isinstance(value, classmethod) else value


def test_the_version_is_that_of_the_library(tool):
    assert tactor.__version__ == tool("--version").split()[1]
    assert "alsa-lib" in tactor.build_facts()


def test_the_markers_need_no_import():
    code = "import sys, tactor; assert 'tactor.lsl' not in sys.modules; print(tactor.lsl.Markers.__name__)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "Markers\n"


def test_modules_import_each_other_in_one_direction():
    imports = {p.stem: set(re.findall(r"^ *from tactor\.(\w+) import", p.read_text(), re.M)) for p in FOLDER.glob("*.py") if p.stem != "__init__"}
    assert {"_errors", "_plan", "_player"} <= set(graphlib.TopologicalSorter(imports).static_order())


def test_everything_public_is_documented():
    without = [name for name, thing in public_things() if not inspect.getdoc(thing)]
    assert without == []


def test_docstrings_name_the_parameters_that_there_are():
    # numpydoc: each section lists the parameters of the signature under their names.
    wrong = []
    for name, thing in public_things():
        function = thing.__init__ if inspect.isclass(thing) else thing
        doc = f"{inspect.getdoc(thing)}\n\n{inspect.getdoc(function) or ''}"
        section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", doc, re.M | re.S)
        if section is None or not inspect.isfunction(function) or name == "Tactor":
            continue
        said = {n.strip() for line in re.findall(r"^(\w[\w, ]*?)(?: : .*)?$", section[1], re.M) for n in line.split(",")}
        has = set(inspect.signature(function).parameters) - {"self", "cls"}
        if said != has:
            wrong.append((name, said ^ has))
    assert wrong == []


def test_types_are_complete(tmp_path, root):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not here: types are not checked")
    assert (FOLDER / "py.typed").exists()
    user = tmp_path / "user.py"
    user.write_text("import tactor\npalm = tactor.Array.preset('palm-3x3')\nplan = tactor.plan(palm, tactor.Stroke.preset('park2016-1'))\n"
                    "reveal_type(plan.amplitudes)\nreveal_type(palm[3])\ntactor.plan(palm, 'x')\n"
                    "tactor.plan(palm, plan.stroke, algorithm='park')\n")
    def mypy(*arguments):
        # mypy looks into a virtual environment, not into PYTHONPATH or the system's Python.
        env = {**os.environ, "MYPYPATH": str(FOLDER.parent)} if "site-packages" not in FOLDER.parts else None
        return subprocess.run([sys.executable, "-m", *arguments], cwd=tmp_path, env=env, capture_output=True, text=True, check=False)
    cache = "--cache-dir", str(tmp_path / "cache")
    r = mypy("mypy", *cache, "--strict", str(root / "src/python/tactor"))
    assert r.returncode == 0, r.stdout + r.stderr
    r = mypy("mypy", *cache, str(user))
    assert "numpy.ndarray" in r.stdout and "tactor._array.Point" in r.stdout, r.stdout
    assert len(re.findall(r"user.py:[67]: error", r.stdout)) == 2 and r.stdout.count("error:") == 2, r.stdout


def test_a_wheel_holds_the_package_alone():
    try:
        files = importlib.metadata.files("tactor") or []
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("the package is not installed by pip: what a wheel holds is not seen")
    tops = {f.parts[0] for f in files}
    assert tops == {"tactor", f"tactor-{tactor.__version__}.dist-info"}, tops
    assert {f.suffix for f in files if f.parts[0] == "tactor"} <= {".py", ".pyi", ".so", ".typed", ".pyc"}


def test_the_extension_exports_only_its_entry_point():
    file = tactor._tactor.__file__
    r = subprocess.run(["nm", "-D", "--defined-only", file], capture_output=True, text=True, check=True)
    assert [line.split()[-1] for line in r.stdout.splitlines()] == ["PyInit__tactor"]
    r = subprocess.run(["ldd", file], capture_output=True, text=True, check=True)
    assert "libtactor.so" not in r.stdout and "cairo" not in r.stdout
