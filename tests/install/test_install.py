# SPDX-License-Identifier: MIT
"""What `meson install` leaves behind: complete, movable, of use to another program, and gone when asked.

Usage: test_install.py TOOL SOURCE_ROOT BUILD_ROOT PREFIX
"""
import json
import os
import pathlib
import re
import shutil
import sys

from building import BUILD, CONSUMER, ROOT, FolderTest, main, run

PREFIX = pathlib.Path(sys.argv[4])


def files_below(folder):
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir()}


class Install(FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # `ninja uninstall` goes by this log, which is that of the user's own installation otherwise.
        log = BUILD / "meson-logs/install-log.txt"
        kept = log.read_bytes() if log.exists() else None
        cls.addClassCleanup(lambda: log.unlink() if kept is None else log.write_bytes(kept))
        run("meson", "install", "-C", BUILD, "--no-rebuild", "--strip", "--destdir", cls.dir / "root")
        cls.log = log.read_bytes()
        cls.installed = cls.dir / "root" / PREFIX.relative_to("/")
        # Moved: nothing may remember where it was put.
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
            "plan", "plans", "compare", "compares", "play", "devices", "check")})

    def test_the_tool_runs_from_where_it_was_moved_to(self):
        tool = self.prefix / "bin/tactor"
        self.assertIn("tactor ", run(tool, "--version", env=self.env))
        self.assertIn("tactor-plan/1", run(tool, "plan", "park2016-1", "--format", "json", env=self.env))
        linked = run("ldd", tool, env=self.env)
        self.assertIn(str(self.libdir.resolve()), linked.replace(str(self.prefix / "bin/.."), str(self.prefix)))

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

    def test_what_manual_and_readme_show_compiles(self):
        page = (ROOT / "man/libtactor.3").read_text(encoding="utf-8")
        example = re.search(r"^\.Bd -literal.*?\n(.*?)^\.Ed", page, re.M | re.S)[1].replace("\\e", "\\")
        (self.dir / "manual.cpp").write_text(example, encoding="utf-8")
        self.compile(self.dir / "manual.cpp", "-o", self.dir / "manual")
        self.assertEqual(run(self.dir / "manual", env=self.env | {"LD_LIBRARY_PATH": str(self.libdir)}), "finished\n")

        readme = (ROOT / "README.md").read_text(encoding="utf-8").partition("## From C++")[2]
        include, body = re.match(r"\s*    (#include <.*>)\n((?:    .*\n|\n)*)", readme).groups()
        (self.dir / "readme.cpp").write_text(f"{include}\nint main()\n{{\n{body}}}\n", encoding="utf-8")
        self.compile(self.dir / "readme.cpp", "-fsyntax-only")

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
