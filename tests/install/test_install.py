# SPDX-License-Identifier: MIT
"""Tests the files of `meson install`: complete, movable, usable by another program, and gone after uninstalling.

Usage: test_install.py TOOL SOURCE_ROOT BUILD_ROOT PREFIX
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

from building import BUILD, CONSUMER, ROOT, FolderTest, main, run

PREFIX = pathlib.Path(sys.argv[4])


def files_below(folder):
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir()}


class Install(FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # `ninja uninstall` uses this log, which is that of the user's own installation otherwise.
        log = BUILD / "meson-logs/install-log.txt"
        kept = log.read_bytes() if log.exists() else None
        cls.addClassCleanup(lambda: log.unlink() if kept is None else log.write_bytes(kept))
        run("meson", "install", "-C", BUILD, "--no-rebuild", "--strip", "--destdir", cls.dir / "root")
        cls.log = log.read_bytes()
        cls.installed = cls.dir / "root" / PREFIX.relative_to("/")
        # Moved: nothing may remember the old place.
        cls.prefix = cls.dir / "elsewhere"
        shutil.copytree(cls.installed, cls.prefix, symlinks=True)
        (pc,) = cls.prefix.rglob("tactor.pc")
        cls.env = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
        cls.env |= {"PKG_CONFIG_PATH": str(pc.parent), "LC_ALL": "C", "XDG_CONFIG_HOME": str(cls.dir / "none")}
        cls.libdir = pc.parent.parent

    def flags(self, *args):
        return run("pkg-config", *args, "tactor", env=self.env).split()

    def test_all_is_there(self):
        there = files_below(self.prefix)
        for header in (ROOT / "include/tactor").glob("*.hpp"):
            self.assertIn(f"include/tactor/{header.name}", there)
        for page in (ROOT / "man").glob("*.[1-8]"):
            section = page.suffix[1:]
            self.assertTrue({f"share/man/man{section}/{page.name}", f"share/man/man{section}/{page.name}.gz"} & there, page)
        for name in ("bin/tactor", "lib/udev/rules.d/70-tactor.rules", "lib/sysusers.d/tactor.conf",
                     "share/bash-completion/completions/tactor", "share/zsh/site-functions/_tactor",
                     "share/fish/vendor_completions.d/tactor.fish"):
            self.assertIn(name, there)
        schemas = {name for name in there if name.startswith("share/tactor/")}
        self.assertEqual(schemas, {f"share/tactor/tactor-{kind}-1.schema.json" for kind in (
            "plan", "analysis", "experiment", "plans", "compare", "compares", "play", "devices", "check", "protocol", "power", "session")})

    def test_the_tool_runs_from_its_new_place(self):
        tool = self.prefix / "bin/tactor"
        self.assertIn("tactor ", run(tool, "--version", env=self.env))
        self.assertIn("tactor-plan/1", run(tool, "plan", "park2016-1", "--format", "json", env=self.env))

    def test_the_tool_has_the_library_within_and_shows_nothing_of_it(self):
        # Libraries that the linker would otherwise look for at each start.
        tool = self.prefix / "bin/tactor"
        self.assertNotIn("libtactor", run("ldd", tool, env=self.env))
        self.assertNotIn("tactor::", run("nm", "-D", "-C", "--defined-only", tool))

    def test_nothing_remembers_where_it_was_built_or_installed(self):
        options = {o["name"]: o["value"] for o in json.loads(run("meson", "introspect", BUILD, "--buildoptions"))}
        if options["b_coverage"]:
            self.skipTest("a build for coverage remembers where its counts go")
        for name in files_below(self.prefix):
            data = (self.prefix / name).read_bytes()
            # The man pages name the usual prefix, and a package's own is all over the system's libraries.
            binary = data[:4] == b"\x7fELF" and str(PREFIX) != "/usr"
            for place in (BUILD, ROOT, self.dir, *[PREFIX] * binary):
                self.assertNotIn(str(place).encode() + b"/", data, f"{name} holds {place}")

    def compile(self, source, *args):
        run(*os.environ.get("CXX", "c++").split(), "-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Werror", source, *args,
            *self.flags("--cflags", "--libs"), env=self.env)

    def test_code_in_manual_and_readme_compiles(self):
        page = (ROOT / "man/libtactor.3").read_text(encoding="utf-8")
        example = re.search(r"^\.Bd -literal.*?\n(.*?)^\.Ed", page, re.M | re.S)[1].replace("\\e", "\\")
        (self.dir / "manual.cpp").write_text(example, encoding="utf-8")
        self.compile(self.dir / "manual.cpp", "-o", self.dir / "manual")
        self.assertEqual(run(self.dir / "manual", env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)}), "finished\n")

        # Complete, as printed, with the printed command.
        readme = (ROOT / "README.md").read_text(encoding="utf-8").partition("## From C++")[2]
        short, body = re.findall(r"(?:^    .*\n(?:\n(?=    ))?)+", readme.partition("\n## ")[0], re.M)
        (self.dir / "short.cpp").write_text(f"#include <tactor/tactor.hpp>\nint main()\n{{\n{short}    return end.frames == 0;\n}}\n", encoding="utf-8")
        self.compile(self.dir / "short.cpp", "-o", self.dir / "short")
        (self.dir / "curve.cpp").write_text(body, encoding="utf-8")
        command = re.search(r"`(c\+\+ .*?)`", readme)[1].replace("c++", os.environ.get("CXX", "c++"), 1)
        run("sh", "-c", command, cwd=self.dir, env=self.env)
        told = subprocess.run([self.dir / "a.out"], capture_output=True, text=True, cwd=self.dir, check=False,
                              env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)})
        self.assertTrue((self.dir / "curve.wav").stat().st_size > 1000)
        if told.returncode:
            self.assertIn("hw:CARD=Tactor", told.stderr)
            self.assertEqual(told.returncode, 1)

    def test_each_header_first_reports_an_old_language(self):
        flags = self.flags("--cflags")
        for header in sorted((self.prefix / "include/tactor").glob("*.hpp")):
            if header.name == "config.hpp":
                continue  # numbers for the preprocessor, which any language takes
            (self.dir / "older.cpp").write_text(f"#include <tactor/{header.name}>\n", encoding="utf-8")
            r = subprocess.run([*os.environ.get("CXX", "c++").split(), "-std=c++17", "-fsyntax-only", self.dir / "older.cpp",
                                *flags], capture_output=True, text=True, check=False, env=self.env)
            errors = [line for line in r.stderr.splitlines() if "error: " in line]
            self.assertRegex(errors[0], "tactor needs C\\+\\+20: -std=c\\+\\+20", header.name)
            self.assertEqual(len(errors), 2, r.stderr)  # the second ends it

    def test_a_program_compiled_for_another_version_does_not_link(self):
        headers = self.dir / "other"
        shutil.copytree(ROOT / "include/tactor", headers / "tactor")
        for header in (headers / "tactor").glob("*.hpp"):
            header.write_text(header.read_text(encoding="utf-8").replace("inline namespace v0 ", "inline namespace v0_2 "), encoding="utf-8")
        flags = run("pkg-config", "--libs", "tactor", env=self.env).split()
        r = subprocess.run([*os.environ.get("CXX", "c++").split(), "-std=c++20", f"-I{headers}", str(CONSUMER / "consumer.cpp"), "-o",
                            str(self.dir / "linked"), *flags], capture_output=True, text=True, check=False, env=self.env)
        self.assertNotEqual(r.returncode, 0)
        self.assertIn("undefined reference to `tactor::v0_2::player::", r.stderr)

    def test_the_uninstalled_library_is_found(self):
        env = self.env | {"PKG_CONFIG_PATH": str(BUILD / "meson-uninstalled")}
        flags = run("pkg-config", "--cflags", "--libs", "tactor", env=env).split()
        run(*os.environ.get("CXX", "c++").split(), "-std=c++20", CONSUMER / "consumer.cpp", "-o", self.dir / "uninstalled",
            *flags, env=env)
        said = run(self.dir / "uninstalled", env=env | {"LD_LIBRARY_PATH": str(BUILD / "src")})
        self.assertIn(": finished\n", said)

    def test_plain_builds_are_hardened_as_packages_are(self):
        options = {o["name"]: o["value"] for o in json.loads(run("meson", "introspect", BUILD, "--buildoptions"))}
        if options["b_sanitize"] != "none":
            self.skipTest("a sanitizer's build is not hardened")
        (library,) = (p for p in self.libdir.glob("libtactor.so.*") if not p.is_symlink())
        for file in (library, self.prefix / "bin/tactor"):
            dynamic, names = run("readelf", "-dlW", file), run("nm", "-D", file)
            self.assertRegex(dynamic, r"BIND_NOW|FLAGS_1.*NOW", file)
            self.assertIn("GNU_RELRO", dynamic, file)
            self.assertIn("__stack_chk_fail", names, file)
            if options["optimization"] not in ("0", "plain"):
                self.assertRegex(names, r"__\w+_chk\b", file)

    def test_the_library_brings_few_others(self):
        library = self.libdir / "libtactor.so"
        needed = run("ldd", library, env=self.env).splitlines()
        self.assertLessEqual(len(needed), 20, needed)

    def test_only_its_names_leave_the_library(self):
        library = self.libdir / "libtactor.so"
        self.assertRegex(run("readelf", "-dW", library), r"SONAME.*\[libtactor\.so\.0\]")
        names = [line.split(" ", 2)[2] for line in run("nm", "-D", "-C", "--defined-only", library).splitlines()]
        own = re.compile(r"((typeinfo( name)?|vtable) for |std::span<)?tactor::v0::")  # a template begins with its return type
        self.assertEqual([n for n in names if not own.match(n)], [])
        for wanted in ("tactor::v0::player::", "tactor::v0::path::from_svg(", "typeinfo for tactor::v0::error", "vtable for tactor::v0::sink"):
            self.assertTrue(any(n.startswith(wanted) for n in names), wanted)

    def test_errors_are_caught_across_the_border(self):
        self.compile(CONSUMER / "errors.cpp", "-o", self.dir / "errors")
        said = run(self.dir / "errors", env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)})
        self.assertEqual(said.splitlines(), ["error: path data", "system_error: tactor", "exception", "own: no level"])

    def test_another_program_compiles_with_pkg_config_and_runs(self):
        program = self.dir / "consumer"
        self.assertIn(f"-I{self.prefix}", " ".join(os.path.normpath(f) if f[0] == "/" else "-I" + os.path.normpath(f[2:])
                                                   for f in self.flags("--cflags")))
        self.compile(CONSUMER / "consumer.cpp", "-o", program)
        said = run(program, env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)})
        self.assertEqual(said, f"tactor {self.flags('--modversion')[0]}: finished\n")

    def test_meson_finds_the_installed_library(self):
        run("meson", "setup", self.dir / "build", CONSUMER, env=self.env)
        run("ninja", "-C", self.dir / "build", env=self.env)
        said = run(self.dir / "build/consumer", env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)})
        self.assertIn(": finished\n", said)

    def test_uninstall_leaves_nothing(self):
        (BUILD / "meson-logs/install-log.txt").write_bytes(self.log)
        run("ninja", "-C", BUILD, "uninstall")
        self.assertEqual(files_below(self.dir / "root"), set())
        self.assertFalse(self.installed.exists())


if __name__ == "__main__":
    main()
