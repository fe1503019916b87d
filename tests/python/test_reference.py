# SPDX-License-Identifier: MIT
"""The reference by Sphinx."""
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


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    if importlib.util.find_spec("sphinx") is None:
        pytest.skip("Sphinx is not here: the reference is not made")
    source = pathlib.Path(__file__).resolve().parents[2] / "src/python/reference"
    folder = tmp_path_factory.mktemp("reference")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", folder / "read", "-b", "html", source, folder / "html"]
    r = subprocess.run(command, env={**os.environ, "LC_ALL": "C.UTF-8"}, capture_output=True, text=True, check=False)
    assert (r.returncode, r.stderr) == (0, "")
    return {p.name: p.read_text(encoding="utf-8") for p in (folder / "html").glob("*.html")}


def test_each_module_has_a_page(pages):
    public = {p.stem for p in pathlib.Path(tactor.__file__).parent.glob("[a-z]*.py")}
    assert {"index.html", "tactor.html"} | {f"{name}.html" for name in public} <= set(pages)


def test_everything_public_is_on_the_page(pages):
    on_it = set(re.findall(r'id="tactor\.([\w.]+)"', pages["tactor.html"]))
    wanted = set(tactor.__all__)
    for name in tactor.__all__:
        thing = getattr(tactor, name)
        if inspect.isclass(thing):
            wanted |= {f"{name}.{m}" for m, v in vars(thing).items()
                       if not m.startswith("_") and (inspect.isfunction(v) or isinstance(v, (classmethod, property)))}
    assert wanted - on_it == set()
    assert "Type:" not in re.sub(r"<[^>]*>", "", pages["tactor.html"]), "a property's first sentence is taken for a type"
