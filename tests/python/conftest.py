# SPDX-License-Identifier: MIT
"""Fixtures of the tests. TACTOR_TOOL names the tool of the same build."""
import os
import pathlib
import shlex
import subprocess

import pytest

import tactor

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pytest_configure(config):
    config.addinivalue_line("markers", "unsanitized: measures, forks, or looks at examples, files and documents: of no use under a sanitizer")


class Tool:
    """The command-line tool, without the user's configuration."""

    def __init__(self, folder):
        self.program = os.environ["TACTOR_TOOL"]
        self.folder = folder

    def __call__(self, *arguments, status=0):
        env = {**os.environ, "TACTOR_CONFIG": os.devnull, "XDG_RUNTIME_DIR": ""}
        r = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder, env=env, capture_output=True, text=True, check=False)
        assert r.returncode == status, r.stderr
        return r.stdout if status == 0 else r.stderr


def in_file(folder, arguments):
    """Moves "key = value" among the tool's arguments into [defaults] of a configuration."""
    keys = [a for a in arguments if " = " in a]
    (folder / "defaults.toml").write_text("\n".join(["[defaults]", *keys]))
    return [a for a in arguments if a not in keys] + ["--config", folder / "defaults.toml"] * bool(keys)


def without_preloaded():
    """Environment for foreign programs: with a sanitizer loaded before them they would fail by their own leaks."""
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def refused(call, kind=tactor.InputError):
    """Returns the error that a call raises."""
    with pytest.raises(kind) as e:
        call()
    return e.value


def compiled(folder, name, *arguments):
    """Path of a C++ library beside the package."""
    file = folder / f"lib{name}.so"
    command = [*shlex.split(os.environ.get("CXX", "c++")), "-std=c++20", "-O2", "-fPIC", "-DPIC", "-shared", "-o", file, *arguments]
    subprocess.run(command, env=without_preloaded(), check=True)
    return file


@pytest.fixture(scope="session")
def felt_pcm(tmp_path_factory):
    """ALSA's configuration of a PCM "felt": without a card, but no null device."""
    folder = tmp_path_factory.mktemp("felt")
    library = compiled(folder, "felt", ROOT / "tests/cli/felt_pcm.cpp", "-lasound")
    file = folder / "asound.conf"
    file.write_text(f'pcm_type.felt {{ lib "{library}" }}\npcm.felt {{ type felt }}\npcm.null {{ type null }}\n')
    return file


@pytest.fixture(scope="session")
def fake_pcm(tmp_path_factory):
    """ALSA's plugin that is the fake DAC."""
    sources = [ROOT / "tests/python/fake_pcm.cpp", *sorted((ROOT / "tests/support").glob("fake_dac*.cpp"))]
    return compiled(tmp_path_factory.mktemp("fake"), "fake", f"-I{ROOT / 'tests/support'}", *sources, "-lasound")


@pytest.fixture(scope="session")
def cpp_library(tmp_path_factory):
    """A program's C++ counterpart of the Python code, with the library of the tool's build."""
    built = pathlib.Path(os.environ["TACTOR_TOOL"]).resolve().parents[1]
    return compiled(tmp_path_factory.mktemp("overhead"), "overhead", f"-I{ROOT / 'include'}", f"-I{built.parent / 'include'}",
                    ROOT / "tests/python/overhead.cpp", f"-L{built}", "-ltactor", f"-Wl,-rpath,{built}")


@pytest.fixture
def tool(tmp_path):
    return Tool(tmp_path)


@pytest.fixture
def palm():
    return tactor.Array.preset("palm-3x3")


@pytest.fixture
def palm_with(tmp_path):
    """Reads palm-3x3 from a file, palm.toml, with more lines."""
    def read(lines):
        (tmp_path / "palm.toml").write_text(f'[array]\npreset = "palm-3x3"\n{lines}')
        return tactor.Array.from_file(tmp_path / "palm.toml")
    return read


@pytest.fixture
def stroke():
    return tactor.Stroke.along(tactor.Path.svg("M 0 10 C 20 -5 20 45 40 30"), duration=1.2)


@pytest.fixture
def root():
    return ROOT


@pytest.fixture
def player(palm):
    with tactor.Player("null", palm, config=os.devnull) as p:
        yield p


@pytest.fixture
def short(palm):
    stroke = tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=0.1)
    return tactor.Score(palm, tactor.plan(palm, stroke, algorithm="continuous"))


@pytest.fixture
def endless(palm):
    stroke = tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=60)
    return tactor.Score(palm, tactor.plan(palm, stroke, algorithm="continuous"), level_dbfs=-60)
