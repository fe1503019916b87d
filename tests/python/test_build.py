# SPDX-License-Identifier: MIT
"""The package's build by pip, and its messages when something is missing."""
import email
import importlib.util
import re
import subprocess
import sys
import zipfile

import pytest

import tactor


@pytest.fixture
def backend(root):
    spec = importlib.util.spec_from_file_location("build_backend", root / "src/python/build_backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_bare_machine_gets_all_missing_parts_in_one_line(backend, monkeypatch, capsys):
    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.delenv("CXX", raising=False)
    with pytest.raises(SystemExit) as e:
        backend.get_requires_for_build_wheel()
    said = capsys.readouterr().err
    assert e.value.code == 1 and said.count("\n") == 1 and said.startswith("tactor: build: missing a C++ compiler")
    for word in ("g++", "libboost-dev", "libasound2-dev", "libgpiod-dev", "setup-args=-Dgpio=disabled"):
        assert word in said
    assert {package for _, package, _ in backend.missing({"setup-args": ["-Dalsa=disabled", "-Dgpio=disabled"]})} \
        == {package for _, package, _ in backend.missing()} - {"libasound2-dev", "libgpiod-dev"}


def test_a_single_missing_library_is_named_alone(backend, monkeypatch, capsys):
    monkeypatch.setattr(backend, "_is_there", lambda compiler, module, header: header != "gpiod.h")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name)
    monkeypatch.setattr(backend.os.path, "exists", lambda path: True)
    with pytest.raises(SystemExit):
        backend.check()
    assert capsys.readouterr().err == ("tactor: build: missing libgpiod (on Debian: apt-get install libgpiod-dev, or do without libgpiod: "
                                       "--config-settings=setup-args=-Dgpio=disabled)\n")
    backend.check({"setup-args": "-Dgpio=disabled"})


@pytest.mark.parametrize("hook", ["prepare_metadata_for_build_wheel", "build_editable", "build_sdist"])
def test_each_hook_of_another_python_says_in_one_line_which_to_use(backend, monkeypatch, capsys, tmp_path, hook):
    monkeypatch.setattr(backend, "missing", lambda config_settings=None: [("mesonpy", "python3-mesonpy", None)])
    monkeypatch.setattr(backend.sys, "base_prefix", "/opt/conda")
    monkeypatch.setattr(backend.sys, "executable", "/opt/conda/bin/python3")
    monkeypatch.setitem(sys.modules, "mesonpy", None)  # an import fails
    with pytest.raises(SystemExit):
        getattr(backend, hook)(tmp_path)
    assert capsys.readouterr().err == (
        "tactor: build: missing mesonpy (on Debian: apt-get install python3-mesonpy; /opt/conda/bin/python3 does not see Debian's Python "
        "packages: make the environment with /usr/bin/python3)\n")


def test_metadata_come_without_compiling(backend, monkeypatch, tmp_path):
    monkeypatch.setattr(backend, "missing", lambda config_settings=None: [])
    monkeypatch.setitem(sys.modules, "mesonpy", None)
    folder = backend.prepare_metadata_for_build_wheel(tmp_path)
    metadata = email.message_from_bytes((tmp_path / folder / "METADATA").read_bytes())
    assert folder == f"tactor-{metadata['Version']}.dist-info" and metadata["Name"] == "tactor"
    assert metadata["Version"] == tactor.__version__ and metadata["Requires-Dist"].startswith("numpy")


def test_its_packages_are_those_of_the_list_and_of_the_guide(backend, root):
    listed = set(re.findall(r"\S+", (root / "tests/packages").read_text()))
    needed = {package for _, package, *_ in backend.LIBRARIES} | {"g++", "pkg-config", "python3-dev", "pybind11-dev", "python3-mesonpy"}
    assert needed <= listed
    guide = (root / "man/guide/python.md").read_text()
    assert "--system-site-packages" in guide and all(f" {package}" in guide for package in needed)


def test_libraries_for_playing_are_required(root):
    setup = (root / "pyproject.toml").read_text()
    assert all(f'"-D{option}"' in setup for option in ("alsa=enabled", "gpio=enabled"))


def test_the_build_takes_as_much_as_memory_allows_and_what_the_user_sets(backend):
    settings = backend.sized({"setup-args": "-Dunity=off", "builddir": "x"})
    assert settings["setup-args"][0] in ("-Dunity=on", "-Dunity=off") and settings["setup-args"][1:] == ["-Dunity=off"]
    assert re.fullmatch(r"-j[1-9]\d*", *settings["compile-args"]) and settings["builddir"] == "x"


def test_wheels_are_compressed(backend, tmp_path):
    with zipfile.ZipFile(tmp_path / "a.whl", "w") as archive:
        archive.writestr("tactor/a.py", "a" * 1000)
    backend.compress(tmp_path / "a.whl")
    with zipfile.ZipFile(tmp_path / "a.whl") as archive:
        assert archive.read("tactor/a.py") == b"a" * 1000 and archive.getinfo("tactor/a.py").compress_size < 100


@pytest.mark.unsanitized
def test_facts_of_the_build_have_the_library_s_versions():
    for name, module in (("toml++", "tomlplusplus"), ("pugixml", "pugixml"), ("fmt", "fmt")):
        version = subprocess.run(["pkg-config", "--modversion", module], capture_output=True, text=True, check=True).stdout.strip()
        assert re.search(rf"{re.escape(name)} ([\d.]+)", tactor.build_facts())[1] == version, tactor.build_facts()


@pytest.mark.unsanitized
def test_the_package_has_no_service():
    said = subprocess.run([sys.executable, "-c", "import tactor; print(open(tactor._tactor.__file__, 'rb').read().count(b'tactor6server'))"],
                          capture_output=True, text=True, check=True)
    assert said.stdout == "0\n"
