# SPDX-License-Identifier: MIT
"""The library's own GPIO tests (tests/amplifier/hw) on a simulated chip: lines, holders, edges, the amplifier's end."""
import re
import subprocess

from rig import BUILD, ENTER, INSIDE, GpioSim, RigTest


class Gpio(RigTest):
    def test_the_library_has_the_expected_version(self):
        facts = self.tool("--version").stdout
        print(facts)
        if INSIDE:  # Debian 13's
            self.assertIn("libgpiod 2.", facts)

    def test_lines_edges_and_the_amplifiers_holder(self):
        sim = GpioSim(lines=8, names=[(2, "tactor-named")])
        self.addCleanup(sim.close)
        r = subprocess.run([*ENTER, BUILD / "tests/amplifier/hw", sim.sysfs, "--no-colors=true"], capture_output=True, text=True,
                           timeout=300, check=False, cwd=self.dir, env=self.env)
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        counts = re.search(r"test cases: *(\d+) \| *(\d+) passed", r.stdout)
        self.assertGreater(int(counts[1]), 10)
        self.assertEqual(counts[1], counts[2])
        print(f"{counts[2]} tests of tests/amplifier/hw passed")
