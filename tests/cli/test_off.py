# SPDX-License-Identifier: MIT
"""tactor off without a GPIO chip: its messages. tests/vm tests the switching on a real kernel."""
import re

from harness import ROOT, ToolTest, main

LINE = '[amplifier]\nline = { chip = "no-such-chip", offset = 17 }\n'


class Off(ToolTest):
    def test_without_an_amplifier_it_is_an_error_that_names_the_file(self):
        config = self.write("mine.toml", '[output]\npcm = "null"\n')
        r = self.run_tool("off", "--config", config)
        self.assertEqual(r.returncode, 2)
        self.assertEqual(r.stdout, "")
        self.assertRegex(r.stderr, r"^tactor: amplifier: no \[amplifier\] in .*mine\.toml \(.*--array\)\n$")
        r = self.run_tool("off")
        self.assertEqual(r.returncode, 2)
        self.assertIn("there is no configuration", r.stderr)

    def test_both_files_are_named_where_neither_has_an_amplifier(self):
        array = self.write("palm.toml", '[array]\npreset = "palm-3x3"\n')
        config = self.write("mine.toml", '[output]\npcm = "null"\n')
        self.refused(2, "off", "--array", array, says=[f"no [amplifier] in {array}, and there is no configuration ("])
        self.refused(2, "off", "--array", array, "--config", config, says=[f"no [amplifier] in {array} or {config} ("])
        self.refused(2, "off", "--array", "palm-2x4", "--config", config, says=[f"no [amplifier] in {config} ("])

    def test_the_shown_example_has_an_amplifier(self):
        example = re.search(r"^Examples:\n  tactor (.*)", self.ok("off", "--help").stdout, re.M)[1]
        self.assertIn(f"\n.Dl tactor {example}\n", (ROOT / "man/tactor-off.1").read_text(encoding="utf-8"))
        self.write("tactor.toml", (ROOT / "examples/tactor.toml").read_bytes())
        self.refused(3, *example.split())

    def test_a_missing_chip_is_an_error(self):
        for name, options in (("config.toml", ["--config"]), ("array.toml", ["--array"])):
            array = '[array]\npreset = "palm-3x3"\n'
            file = self.write(name, array + LINE)
            r = self.run_tool("off", *options, file)
            self.assertEqual(r.returncode, 3, r.stderr)
            self.assertEqual(r.stdout, "")
            self.assertIn("no-such-chip", r.stderr)

    def test_it_takes_no_stroke(self):
        self.assertEqual(self.run_tool("off", "park2016-1").returncode, 2)

    def test_the_unit_in_examples_switches_off_after_its_end(self):
        unit = (ROOT / "examples/systemd/tactor-play@.service").read_text(encoding="utf-8")
        after = re.search(r"^ExecStopPost=-(\S+) off$", unit, re.M)
        self.assertEqual(after[1], re.search(r"^ExecStart=(\S+) play ", unit, re.M)[1])


if __name__ == "__main__":
    main()
