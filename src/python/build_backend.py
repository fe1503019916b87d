# SPDX-License-Identifier: MIT
"""The build backend of pip: meson-python, after a look at what this machine lacks.

Meson stops at the first library that it does not find, under a page of pip's own words. This names all of them in one line.
"""
import importlib.util
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

# Required libraries: a pkg-config name or a header, the Debian package, and the option that builds without it.
LIBRARIES = (
    ("Boost", "libboost-dev", None, None, "boost/asio.hpp"),
    ("fmt", "libfmt-dev", None, "fmt", "fmt/format.h"),
    ("libmd", "libmd-dev", None, "libmd", "sha2.h"),
    ("pugixml", "libpugixml-dev", None, "pugixml", "pugixml.hpp"),
    ("toml++", "libtomlplusplus-dev", None, "tomlplusplus", "toml++/toml.h"),
    ("nlohmann-json", "nlohmann-json3-dev", None, "nlohmann_json", "nlohmann/json.hpp"),
    ("ALSA", "libasound2-dev", "alsa", "alsa", "alsa/asoundlib.h"),
    ("libgpiod", "libgpiod-dev", "gpio", "libgpiod", "gpiod.h"),
)


def __getattr__(name):
    """The other hooks are meson-python's."""
    if name.startswith("_"):
        raise AttributeError(name)
    return getattr(_mesonpy(), name)


def get_requires_for_build_wheel(config_settings=None):
    check(config_settings)
    return _mesonpy().get_requires_for_build_wheel(config_settings)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the package's metadata; returns the name of their folder. Without this hook pip compiles everything for them."""
    check(config_settings)
    import pyproject_metadata  # meson-python needs it, too
    root = pathlib.Path(__file__).resolve().parents[2]
    with open(root / "pyproject.toml", "rb") as file:
        metadata = pyproject_metadata.StandardMetadata.from_pyproject(tomllib.load(file), root)
    folder = pathlib.Path(metadata_directory, f"{metadata.name}-{metadata.version}.dist-info")
    folder.mkdir()
    (folder / "METADATA").write_bytes(bytes(metadata.as_rfc822()))
    return folder.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    check(config_settings)
    name = _mesonpy().build_wheel(wheel_directory, sized(config_settings), metadata_directory)
    compress(pathlib.Path(wheel_directory) / name)
    return name


def compress(wheel):
    """Compresses a wheel's files, which meson-python 0.12 stores as they are."""
    with zipfile.ZipFile(wheel) as archive:
        files = [(file, archive.read(file)) for file in archive.infolist()]
    with zipfile.ZipFile(wheel, "w") as archive:
        for file, data in files:
            archive.writestr(file, data, zipfile.ZIP_DEFLATED)


def sized(config_settings=None):
    """Returns the settings with as many jobs as the memory is enough for; what the user set comes last, and holds."""
    tests = pathlib.Path(__file__).resolve().parents[2] / "tests"
    jobs, unity = subprocess.run([tests / "jobs", "wheel"], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
    settings = dict(config_settings or {})
    for key, value in (("setup-args", f"-Dunity={unity}"), ("compile-args", f"-j{jobs}")):
        settings[key] = [value, *_listed(settings.get(key, []))]
    return settings


def check(config_settings=None):
    """Ends the build with one line where something is missing."""
    lacks = missing(config_settings)
    if lacks:
        without = "".join(f", or do without {name}: --config-settings=setup-args=-D{option}=disabled" for name, _, option in lacks if option)
        if sys.base_prefix != "/usr" and any(package.startswith("python3-") for _, package, _ in lacks):
            without += f"; {sys.executable} does not see Debian's Python packages: make the environment with /usr/bin/python3"
        print(f"tactor: build: missing {', '.join(name for name, *_ in lacks)} (on Debian: apt-get install "
              f"{' '.join(package for _, package, _ in lacks)}{without})", file=sys.stderr)
        raise SystemExit(1)


def missing(config_settings=None):
    """(name, Debian's package, option) of all that is needed and not here."""
    off = _switched_off(config_settings)
    lacks = []
    compiler = shlex.split(os.environ.get("CXX", "")) or [next((c for c in ("c++", "g++", "clang++") if shutil.which(c)), "c++")]
    if not shutil.which(compiler[0]):
        lacks.append(("a C++ compiler", "g++", None))
    if not (shutil.which("pkg-config") or shutil.which("pkgconf")):
        lacks.append(("pkg-config", "pkg-config", None))
    if not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")):
        lacks.append(("Python's headers", "python3-dev", None))
    for name, package, option, module, header in LIBRARIES:
        if option not in off and not _is_there(compiler, module, header):
            lacks.append((name, package, option))
    for module, package in (("mesonpy", "python3-mesonpy"), ("pybind11", "pybind11-dev")):
        if importlib.util.find_spec(module) is None and not _succeeds(["pkg-config", "--exists", module]):
            lacks.append((module, package, None))
    return lacks


def _switched_off(config_settings):
    given = _listed((config_settings or {}).get("setup-args", []))
    return {option for _, _, option, *_ in LIBRARIES if option and f"-D{option}=disabled" in given}


def _listed(given):
    return [given] if isinstance(given, str) else given


def _is_there(compiler, module, header):
    if module is not None and _succeeds(["pkg-config", "--exists", module]):
        return True
    return _succeeds([*compiler, "-E", "-x", "c++", "-"], f"#if !__has_include(<{header}>)\n#error\n#endif\n")


def _succeeds(command, text=""):
    try:
        return subprocess.run(command, input=text, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0
    except OSError:
        return False


def _mesonpy():
    try:
        import mesonpy
    except ModuleNotFoundError:
        check()
        raise
    return mesonpy
