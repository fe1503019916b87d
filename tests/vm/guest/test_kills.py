# SPDX-License-Identifier: MIT
"""`tactor play` killed at its system calls (tests/cli/test_killed.cpp), with the amplifier on a simulated chip."""
import subprocess

from rig import BUILD, ENTER, TOOL, AmplifierTest


class Kills(AmplifierTest):
    def test_play_killed_at_its_system_calls_leaves_the_amplifier_off(self):
        env = self.env | {"TACTOR_TOOL": str(TOOL), "TACTOR_ARRAY": str(self.array),
                          "TACTOR_LINE": str(self.gpio.sysfs / f"sim_gpio{self.LINE}/value")}
        r = subprocess.run([*ENTER, BUILD / "tests/cli/test-killed", "--no-colors=true"], capture_output=True, text=True,
                           timeout=400, check=False, cwd=self.dir, env=env)
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        self.assertNotIn("SKIPPED", r.stdout)
        print(*(line for line in r.stdout.splitlines() if line.startswith("play killed at")), sep="\n")
