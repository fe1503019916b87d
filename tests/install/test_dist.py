# SPDX-License-Identifier: MIT
"""The tarball that `meson dist` makes builds, installs without DESTDIR, and serves as a subproject.
Each file by itself, with warnings as errors, without the tests; nothing is made fast, which the suite and the packages do.

Usage: test_dist.py TOOL SOURCE_ROOT BUILD_ROOT. Compiles the library twice.
"""
import os
import shutil
import tarfile

from building import BUILD, CONSUMER, FolderTest, main, run

# A third of the time: see lanes/say.
TOGETHER = ["-Dunity=on", "-Dunity_size=40"]


class Dist(FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        run("meson", "dist", "-C", BUILD, "--no-tests", "--allow-dirty", "--formats", "gztar")
        (tarball,) = (BUILD / "meson-dist").glob("tactor-*.tar.gz")
        with tarfile.open(tarball) as t:
            t.extractall(cls.dir)
        (cls.source,) = cls.dir.glob("tactor-*")

    def test_it_builds_and_installs_without_destdir_and_uninstalls(self):
        build, prefix = self.source / "build", self.dir / "prefix"
        run("meson", "setup", build, self.source, "--prefix", prefix, "-Dwerror=true", "-Doptimization=0", "-Dtests=disabled", "-Dbenchmarks=disabled")
        run("ninja", "-C", build)
        run("meson", "install", "-C", build, "--no-rebuild")
        (pc,) = prefix.rglob("tactor.pc")
        env = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"} | {"PKG_CONFIG_PATH": str(pc.parent)}
        self.assertIn("tactor ", run(prefix / "bin/tactor", "--version", env=env))
        flags = run("pkg-config", "--cflags", "--libs", "tactor", env=env).split()
        run(*os.environ.get("CXX", "c++").split(), "-std=c++20", CONSUMER / "consumer.cpp", "-o", self.dir / "consumer", *flags)
        said = run(self.dir / "consumer", env=env | {"LD_LIBRARY_PATH": str(pc.parent.parent)})
        self.assertIn(": finished\n", said)
        run("ninja", "-C", build, "uninstall")
        self.assertFalse(prefix.exists())

    def test_as_a_subproject_only_the_library_is_built(self):
        project = self.dir / "project"
        shutil.copytree(CONSUMER, project)
        shutil.copytree(self.source, project / "subprojects/tactor", ignore=shutil.ignore_patterns("build"))
        # An installed library would be preferred.
        run("meson", "setup", project / "build", project, "--wrap-mode=forcefallback", "-Dbuildtype=plain", "-Doptimization=0", *TOGETHER)
        run("ninja", "-C", project / "build")
        self.assertIn(": finished\n", run(project / "build/consumer"))
        built = {p.name for p in (project / "build").rglob("*")
                 if p.is_file() and os.access(p, os.X_OK) and "meson-private" not in p.parts}
        self.assertEqual({n for n in built if not n.startswith("libtactor.so")}, {"consumer"})


if __name__ == "__main__":
    main()
