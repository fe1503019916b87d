# SPDX-License-Identifier: MIT
"""The installed package, its documentation and types, files written from the table of options, and what Python costs."""
import ctypes
import graphlib
import importlib.metadata
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys
import time

import numpy as np
import pytest

import tactor
from conftest import ROOT

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


@pytest.mark.parametrize("module,name", [("lsl", "Markers"), ("study", "analyze")])
def test_modules_need_no_import(module, name):
    code = f"import sys, tactor; assert 'tactor.{module}' not in sys.modules; print(tactor.{module}.{name}.__name__)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == f"{name}\n"


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
    assert "libtactor.so" not in r.stdout


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    if importlib.util.find_spec("sphinx") is None:
        pytest.skip("Sphinx is not here: the reference is not made")
    source = ROOT / "src/python/reference"
    folder = tmp_path_factory.mktemp("reference")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", folder / "read", "-b", "html", source, folder / "html"]
    r = subprocess.run(command, env={**os.environ, "LC_ALL": "C.UTF-8"}, capture_output=True, text=True, check=False)
    assert (r.returncode, r.stderr) == (0, "")
    return {p.name: p.read_text(encoding="utf-8") for p in (folder / "html").glob("*.html")}


def test_each_module_has_a_page(pages):
    public = {p.stem for p in FOLDER.glob("[a-z]*.py")}
    assert {"index.html", "tactor.html"} | {f"{name}.html" for name in public} <= set(pages)


def test_everything_public_is_on_the_page(pages):
    on_it = set(re.findall(r'id="tactor\.([\w.]+)"', pages["tactor.html"]))
    assert {name for name, _ in public_things()} - on_it == set()
    assert "Type:" not in re.sub(r"<[^>]*>", "", pages["tactor.html"]), "a property's first sentence is taken for a type"


@pytest.fixture(scope="module")
def writer():
    sys.path.insert(0, str(ROOT / "src/options"))
    return importlib.import_module("write")


def test_written_files_are_current(writer):
    assert {"_plan.py", "_player.py", "tactor-options.7", "tactor-play.1"} <= {file.name for file in writer.WRITTEN}
    for file, write in writer.WRITTEN.items():
        text = file.read_text(encoding="utf-8")
        assert text == write(text), f"{file.name}: run python3 src/options/write.py, where tactor can be imported"


def test_each_stroke_format_has_its_section_in_the_manual(writer):
    page = writer.PAGE.read_text(encoding="utf-8")
    strokes = page[page.index(".Sh STROKES"):page.index(".Sh FILES")]
    for row in writer.FORMATS:
        assert f"\n.Ss {row['title']}\n" in strokes, f"{row['title']}: man/{writer.PAGE.name} does not describe it"
        assert f"\n{row['title']}\t{row['extensions'][0]}\t{row['name']}\t" in strokes


def test_signatures_and_docstrings_have_each_option(writer):
    calls = {"plan": tactor.plan, "compare": tactor.compare, "score": tactor.Score, "player": tactor.Player}
    for row in map(writer.in_seconds, writer.ROWS):
        for place in set(row["places"]) & set(calls):
            assert inspect.signature(calls[place]).parameters[row["name"]].default is None
            doc = inspect.getdoc(calls[place].__init__ if inspect.isclass(calls[place]) else calls[place])
            assert re.search(rf"^(\w+, )*{row['name']}(,| :|$)", doc, re.M), row["name"]
    live = inspect.signature(tactor.Player.live).parameters
    assert {"soa", "envelope", "timeout"} <= set(live) and "duration" not in live
    assert live["smooth"].default == 0.0 and str(live["algorithm"].annotation) == "_Algorithm | None"


def importing(code):
    best = 1e9
    for _ in range(15):
        r = subprocess.run([sys.executable, "-c", f"import time; a = time.process_time(); {code}; print(time.process_time() - a)"],
                           capture_output=True, text=True, check=True)
        best = min(best, float(r.stdout))
    return best


def test_importing_takes_little_time_alone_and_little_more_than_numpy():
    numpy = importing("import numpy")
    both, alone = importing("import numpy, tactor"), importing("import tactor")
    print(f"import numpy {1e3 * numpy:.1f} ms, with tactor {both / numpy:.2f} times that, tactor alone {1e3 * alone:.1f} ms")
    # Aims are 1.5 times and 30 ms; machines differ, and a shared one is noisy: the test holds it near there.
    assert both < 1.7 * numpy
    assert alone < 0.6 * numpy
    assert "numpy" not in subprocess.run([sys.executable, "-c", "import tactor, sys; print([m for m in sys.modules if m == 'numpy'])"],
                                         capture_output=True, text=True, check=True).stdout


def test_planning_and_rendering_take_little_more_than_from_cpp(palm, cpp_library):
    program = ctypes.CDLL(str(cpp_library))
    program.plan_and_render.restype = None
    stroke = tactor.Stroke.preset("park2016-3")

    def in_python():
        return tactor.Score(palm, tactor.plan(palm, stroke)).render()

    def in_cpp():
        return program.plan_and_render(None)
    samples = in_python()
    theirs = np.zeros_like(samples)
    program.plan_and_render(theirs.ctypes.data_as(ctypes.c_void_p))
    assert np.array_equal(samples, theirs)
    least = {in_python: 1e9, in_cpp: 1e9}
    for _ in range(10):  # by turns, so that a busy machine treats both alike
        for work in least:
            for _ in range(50):
                began = time.thread_time()
                work()
                least[work] = min(least[work], time.thread_time() - began)
    ratio = least[in_python] / least[in_cpp]
    print(f"planning and rendering park2016-3 takes {ratio:.3f} times what it takes from C++")
    # The aim is 1.05, which it is within a few per cent of noise.
    assert ratio < 1.2, least
