# SPDX-License-Identifier: MIT
"""tactor devices: PCMs with their properties, and GPIO chips, on any machine."""
import json

from harness import ALSA_CONFIG, ToolTest, main

MORE_PCMS = """
pcm.mixed { type dmix ipc_key 4711 slave.pcm "null" }
pcm.over_a_mixer { type plug slave.pcm "mixed" }
pcm.through_a_slave { type plug slave "named_slave" }
pcm_slave.named_slave { pcm "mixed" }
pcm.round_and_round { type plug slave.pcm "round_and_round" }
pcm.sixteen_bits { type linear slave { pcm "null" format S16_LE } }
pcm.broken { type linear slave { pcm "null" format "no such format" } }
pcm.kept { type file slave.pcm "null" file "kept.raw" format raw }
pcm.said { type null hint { show on description "first line
second line" } }
"""


class Devices(ToolTest):
    def devices(self, *args):
        told = json.loads(self.ok("devices", "--format", "json", *args).stdout)
        self.assertEqual(told["schema"], "tactor-devices/1")
        return told, {p["name"]: p for p in told["pcms"]}

    def test_pcms_of_the_configuration_are_listed_with_their_properties(self):
        told, pcms = self.devices()
        self.assertEqual(told["wanted"], {"array": "palm-3x3", "channels": 9, "rate_hz": 48000, "format": None})
        self.assertIn("default", pcms)
        self.assertNotIn("raw", pcms)  # needs an argument
        self.assertEqual(pcms["null"]["can"]["channels"], [{"min": 1, "max": 1024}])
        self.assertEqual(pcms["null"]["can"]["rate_hz"]["max"], None)
        self.assertEqual((pcms["null"]["fits"], pcms["null"]["misfit"]), (True, None))
        self.assertEqual(pcms["eight"]["can"]["channels"], [{"min": 8, "max": 8}])
        self.assertEqual(pcms["eight"]["fits"], False)
        self.assertIn("cannot play 9 channels at 48000 Hz", pcms["eight"]["misfit"])
        self.assertEqual(len(told["pcms"]), len(pcms), "a name is listed twice")

    def test_fitting_pcms_follow_array_rate_and_format(self):
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        self.assertTrue(self.devices("--array", "palm-2x4")[1]["eight"]["fits"])
        self.assertEqual(self.devices("--rate", "44100")[0]["wanted"]["rate_hz"], 44100)
        self.assertIn("s32", self.devices()[1]["sixteen_bits"]["can"]["formats"])
        self.assertTrue(self.devices("--sample-format", "s32")[1]["sixteen_bits"]["fits"])
        told, pcms = self.devices("--sample-format", "float")
        self.assertEqual((told["wanted"]["format"], pcms["sixteen_bits"]["fits"]), ("float", False))
        self.assertIn("refused: format", pcms["sixteen_bits"]["misfit"])
        self.write("a.toml", '[array]\nname = "mine"\ngrid = { rows = 1, columns = 2, pitch_mm = 40.0 }\n'
                             '[output]\npcm = "eight"\nchannels = 8\nrate = 96000\n')
        told, pcms = self.devices("--array", "a.toml")
        self.assertEqual(told["wanted"], {"array": "mine", "channels": 8, "rate_hz": 96000, "format": None})
        self.assertEqual([n for n, p in pcms.items() if p["configured"]], ["eight"])
        self.assertEqual([n for n, p in self.devices("--array", "a.toml", "-D", "null")[1].items() if p["configured"]], ["null"])

    def test_a_definition_on_which_libasound_ends_the_process_is_refused_and_the_rest_listed(self):
        self.write("alsa.conf", ALSA_CONFIG + """pcm.hole { type multi slaves.a { pcm "null" channels 4 }
            bindings { 0 { slave a channel 0 } 1 { slave a channel 1 } 3 { slave a channel 3 } } }\n""")
        _, pcms = self.devices()
        self.assertIn("type multi leaves a hole in its bindings: it binds no channel 2", pcms["hole"]["error"])
        self.assertTrue(pcms["null"]["fits"])
        self.refused(3, "play", "park2016-1", "-D", "hole", says=["it binds no channel 2"])
        self.assertEqual(self.run_tool("check", "-D", "hole").returncode, 3)

    def test_a_configuration_that_alsa_cannot_read_is_reported_with_file_and_line(self):
        self.write("alsa.conf", ALSA_CONFIG + "pcm.output {\n  type hw\n  card \n}\n")
        said = f"alsa.conf:{(ALSA_CONFIG + 'pcm.output {').count(chr(10)) + 5}: ALSA cannot read its configuration"
        self.assertIn(said, self.devices()[1]["null"]["error"])
        self.refused(3, "play", "park2016-1", "-D", "null", says=[said])

    def test_mixers_are_named_and_not_started(self):
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        _, pcms = self.devices()
        for name in ("mixed", "over_a_mixer", "through_a_slave"):
            self.assertEqual((pcms[name]["tried"], pcms[name]["opened"], pcms[name]["can"]), (False, False, None))
            self.assertIn("dmix", pcms[name]["error"])
        self.assertTrue(self.devices("-D", "mixed")[1]["mixed"]["tried"])
        text = self.ok("devices").stdout
        self.assertIn("Not tried", text)
        self.assertIn("mixed over_a_mixer", text)

    def test_a_pcm_that_cannot_be_opened_gives_its_reason(self):
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        _, pcms = self.devices("-D", "hw:CARD=Nowhere")
        self.assertEqual((pcms["round_and_round"]["tried"], pcms["round_and_round"]["opened"]), (False, False))
        self.assertIn("leads to itself", pcms["round_and_round"]["error"])
        for name in ("broken", "hw:CARD=Nowhere"):
            self.assertEqual((pcms[name]["tried"], pcms[name]["opened"], pcms[name]["fits"]), (True, False, None))
            self.assertTrue(pcms[name]["error"])
            self.assertNotIn("PCM \"", pcms[name]["error"])
        self.assertTrue(pcms["hw:CARD=Nowhere"]["configured"])
        self.assertEqual(pcms["said"]["description"], "first line, second line")
        self.assertIn("hw:CARD=Nowhere   <- the one that is configured", self.ok("devices", "-D", "hw:CARD=Nowhere").stdout)

    def test_a_missing_plugin_is_named_with_its_package(self):
        (self.dir / "plugins").mkdir()
        env = {"ALSA_PLUGIN_DIR": str(self.dir / "plugins")}
        for kind, package in (("pulse", "libasound2-plugins"), ("pipewire", "pipewire-alsa")):
            self.write("alsa.conf", f"pcm.!default {{ type {kind} }}\n")
            for command in (("play", "park2016-1"), ("check",)):
                r = self.refused(3, *command, "-D", "default", env=env, says=[f"libasound_module_pcm_{kind}.so"])
                self.assertIn(f"sudo apt install {package}", r.stdout + r.stderr)
                self.assertNotIn("no sound card", r.stdout + r.stderr)

    def test_a_named_file_pcm_is_listed_and_not_made(self):
        _, pcms = self.devices("-D", f"raw:{self.dir}/out.raw")
        self.assertEqual((pcms[f"raw:{self.dir}/out.raw"]["configured"], pcms[f"raw:{self.dir}/out.raw"]["tried"]), (True, False))
        self.assertIn("type file", pcms[f"raw:{self.dir}/out.raw"]["error"])
        self.assertFalse((self.dir / "out.raw").exists())

    def test_no_file_is_opened_that_would_be_emptied(self):
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        self.write("kept.raw", "precious")
        for args in ((), ("-D", "kept"), ("-D", "raw:kept.raw")):
            self.assertFalse(self.devices(*args)[1]["kept"]["opened"])
        self.assertEqual((self.dir / "kept.raw").read_text(), "precious")

    def test_text_is_plain_and_fits_80_columns(self):
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        r = self.ok("devices", env={"LC_ALL": "de_DE.UTF-8"})
        self.assertEqual(r.stderr, "")
        self.assertNotIn("\033", r.stdout)
        self.assertLessEqual(max(map(len, r.stdout.splitlines())), 79)
        for text in ("palm-3x3 needs 9 channels at 48000 Hz", "Sound cards\n", "Other PCMs\n", "GPIO chips\n", "    channels  8\n",
                     "    fits      palm-3x3\n"):
            self.assertIn(text, r.stdout)

    def test_a_machine_without_cards_and_chips_gets_a_hint(self):
        told, _ = self.devices()
        text = self.ok("devices").stdout
        if any(p["hardware"] for p in told["pcms"]):
            self.assertNotIn("none; load the card", text)
        else:
            self.assertIn("  none; load the card's driver or overlay", text)
        self.assertEqual("none; they are /dev/gpiochip*" in text, not told["gpio_chips"])

    def test_wrong_usage_is_refused(self):
        self.refused(2, "devices", "--format", "csv")
        self.refused(2, "devices", "--array", "palm-9x9")
        self.refused(2, "devices", "park2016-1")


if __name__ == "__main__":
    main()
