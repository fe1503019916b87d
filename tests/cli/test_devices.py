# SPDX-License-Identifier: MIT
"""PCMs for all commands: those that tactor devices lists, their channels and wiring, those that files by others name; tactor off."""
import json
import os
import re

from harness import ALSA_CONFIG, GRID, ROOT, ToolTest, main
from serving import Server

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
AMPLIFIER = '[amplifier]\nline = { chip = "no-such-chip", offset = 17 }\n'


class DevicesTest(ToolTest):
    STROKE = ("--path", "M 20 40 L 40 40", "--duration", "0.2")  # from tactor 7 to 8

    def devices(self, *args):
        told = json.loads(self.ok("devices", "--format", "json", *args).stdout)
        return told, {p["name"]: p for p in told["pcms"]}

    def check_device(self, pcm, *args, status=0):
        """Returns the finding of tactor check about a device."""
        r = self.run_tool("check", "--format", "json", "-D", pcm, *args)
        self.assertEqual(r.returncode, status, r.stdout + r.stderr)
        return next(f for f in json.loads(r.stdout)["findings"] if f["check"] == "device")


class Devices(DevicesTest):
    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        self.write("kept.raw", "precious")

    def test_pcms_of_the_configuration_are_listed_with_their_properties(self):
        told, pcms = self.devices()
        self.assertEqual((told["schema"], told["wanted"]), ("tactor-devices/1", {"array": "palm-3x3", "channels": 9, "rate_hz": 48000, "format": None}))
        self.assertTrue("default" in pcms and "raw" not in pcms)  # which needs an argument
        self.assertEqual((pcms["null"]["can"]["channels"], pcms["null"]["can"]["rate_hz"]["max"]), ([{"min": 1, "max": 1024}], None))
        self.assertEqual((pcms["null"]["fits"], pcms["null"]["misfit"]), (True, None))
        self.assertEqual((pcms["eight"]["can"]["channels"], pcms["eight"]["fits"]), ([{"min": 8, "max": 8}], False))
        self.assertIn("cannot play 9 channels at 48000 Hz", pcms["eight"]["misfit"])
        self.assertEqual(pcms["said"]["description"], "first line, second line")
        self.assertEqual(len(told["pcms"]), len(pcms), "a name is listed twice")

    def test_fitting_pcms_follow_array_rate_and_format(self):
        self.assertTrue(self.devices("--array", "palm-2x4")[1]["eight"]["fits"])
        self.assertTrue(self.devices("--sample-format", "s32")[1]["sixteen_bits"]["fits"])
        told, pcms = self.devices("--sample-format", "float", "--rate", "44100")
        self.assertEqual((told["wanted"]["rate_hz"], told["wanted"]["format"], pcms["sixteen_bits"]["fits"]), (44100, "float", False))
        self.assertIn("unsupported format", pcms["sixteen_bits"]["misfit"])
        self.write("a.toml", '[array]\nname = "mine"\ngrid = { rows = 1, columns = 2, pitch_mm = 40.0 }\n'
                             '[output]\npcm = "eight"\nchannels = 8\nrate = 96000\n')
        told, pcms = self.devices("--array", "a.toml")
        self.assertEqual(told["wanted"], {"array": "mine", "channels": 8, "rate_hz": 96000, "format": None})
        self.assertEqual([n for n, p in pcms.items() if p["configured"]], ["eight"])
        self.assertEqual([n for n, p in self.devices("--array", "a.toml", "-D", "null")[1].items() if p["configured"]], ["null"])

    def test_pcms_that_are_not_tried_or_not_opened_have_their_reason_and_empty_no_file(self):
        text = self.ok("devices").stdout
        self.assertTrue("Not tried" in text and "mixed over_a_mixer" in text, text)
        for args in ((), ("-D", "hw:CARD=Nowhere"), ("-D", "kept"), ("-D", "raw:kept.raw"), ("-D", f"raw:{self.dir}/out.raw")):
            _, pcms = self.devices(*args)
            for name, error in (("mixed", "dmix"), ("over_a_mixer", "dmix"), ("through_a_slave", "dmix"), ("round_and_round", "refers to itself")):
                self.assertEqual((pcms[name]["tried"], pcms[name]["opened"], pcms[name]["can"]), (False, False, None))
                self.assertIn(error, pcms[name]["error"])
            for name in ("broken", *(n for n in args if n.startswith("hw:"))):
                self.assertEqual((pcms[name]["tried"], pcms[name]["opened"], pcms[name]["fits"]), (True, False, None))
                self.assertTrue(pcms[name]["error"] and 'PCM "' not in pcms[name]["error"])
            for name in args[1:]:
                self.assertTrue(pcms[name]["configured"] and not pcms[name]["opened"])
            self.assertFalse(pcms["kept"]["opened"])
        self.assertTrue(self.devices("-D", "mixed")[1]["mixed"]["tried"])
        self.assertIn("hw:CARD=Nowhere   <- the configured one", self.ok("devices", "-D", "hw:CARD=Nowhere").stdout)
        self.assertEqual(((self.dir / "kept.raw").read_text(), (self.dir / "out.raw").exists()), ("precious", False))

    def test_text_is_plain_fits_80_columns_and_has_a_hint_where_there_is_nothing(self):
        r = self.ok("devices", env={"LC_ALL": "de_DE.UTF-8"})
        self.assertEqual((r.stderr, "\033" in r.stdout), ("", False))
        self.assertLessEqual(max(map(len, r.stdout.splitlines())), 79)
        for text in ("palm-3x3 needs 9 channels at 48000 Hz", "Sound cards\n", "Other PCMs\n", "GPIO chips\n", "    channels  8\n",
                     "    fits      palm-3x3\n"):
            self.assertIn(text, r.stdout)
        told, _ = self.devices()
        self.assertEqual("  none; plug in the card, or load its driver or overlay" in r.stdout, not any(p["hardware"] for p in told["pcms"]))
        self.assertEqual("none; they are /dev/gpiochip*" in r.stdout, not told["gpio_chips"])


class Channels(DevicesTest):
    """Cards with more or fewer channels than the array, without a choice of channels."""
    FITS = "the array palm-2x4 fits"

    def setUp(self):
        super().setUp()
        fixed = "".join("pcm.%s { type multi slaves.a { pcm { type null } channels %d }\n%s }\n" % (
            name, n, "\n".join(f"bindings.{c} {{ slave a channel {c} }}" for c in range(n))) for name, n in (("sixteen", 16), ("ten", 10)))
        self.write("alsa.conf", ALSA_CONFIG + fixed)

    def test_the_fewest_channels_that_hold_array_and_marker_are_taken(self):
        self.write("a.toml", 'array.preset = "palm-3x3"\nsync.channel = 12\n')
        self.assertIn("13 of 16 channels", self.ok("play", *self.STROKE, "--array", "a.toml", "-D", "sixteen").stdout)

    def test_every_command_takes_them(self):
        for device, channels in (("sixteen", 16), ("null", 9)):
            told = json.loads(self.ok("play", *self.STROKE, "-D", device, "--format", "json").stdout)
            self.assertEqual((told["device"]["channels"], told["device"]["device_channels"]), (9, channels))
        self.write("p.json", self.ok("plan", *self.STROKE, "--format", "json").stdout)
        self.assertIn("9 of 16 channels", self.ok("play", "p.json", "-D", "sixteen").stdout)
        self.assertIn("9 of 16 channels", self.ok("play", "--live", "-", "-D", "sixteen", stdin="20 20\n").stdout)
        self.ok("check", "--walk", "--auto", "-D", "sixteen")
        found = self.check_device("sixteen")
        self.assertTrue(found["level"] == "ok" and "9 of 16 channels" in found["found"], found)
        c = Server(self, device=("-D", "sixteen")).client()
        self.assertEqual(c.ok("hello")["stream"]["channels"], 9)
        self.assertEqual(c.await_end(c.ok("play", stroke="park2016-1", options={"duration": 0.2})["stroke"])["state"], "finished")

    def test_a_given_number_is_exact(self):
        self.assertIn(": 16 channels,", self.ok("play", *self.STROKE, "-D", "sixteen", "--channels", "16").stdout)
        self.assertNotIn("fits", self.refused(3, "play", *self.STROKE, "-D", "sixteen", "--channels", "9").stderr)
        for number in ("8", "0"):
            self.refused(2, "play", *self.STROKE, "-D", "sixteen", "--channels", number)
        self.write("a.toml", 'array.preset = "palm-3x3"\noutput.channels = 10\n')
        self.refused(3, "play", *self.STROKE, "--array", "a.toml", "-D", "sixteen")
        self.assertIn(": 10 channels,", self.ok("play", *self.STROKE, "--array", "a.toml", "-D", "ten").stdout)
        self.ok("render", *self.STROKE, "--channels", "16", "-o", "o.wav")
        self.assertEqual((self.dir / "o.wav").read_bytes()[22:24], (16).to_bytes(2, "little"))

    def test_a_card_with_fewer_channels_names_an_array_that_fits_or_the_marker(self):
        self.refused(3, "play", *self.STROKE, "-D", "eight", says=["cannot play 9 channels", "use channels: 8", self.FITS])
        self.refused(3, "serve", "--socket", f"{self.dir}/s", "-D", "eight")  # it does not wait for that
        self.assertIn(self.FITS, self.check_device("eight", status=3)["cure"])
        pcms = self.devices()[1]
        self.assertEqual([pcms[n]["fits"] for n in ("sixteen", "ten", "eight")], [True, True, False])
        self.assertIn(self.FITS, pcms["eight"]["misfit"])
        self.write("a.toml", 'array.preset = "palm-2x4"\nsync.channel = 12\n')
        says = "for the marker or plan, use a spare channel instead of channel 12"
        self.refused(3, "play", "--path", "M 0 0 L 60 0", "--array", "a.toml", "-D", "eight", says=[says])
        self.assertIn(says, self.devices("--array", "a.toml")[1]["eight"]["misfit"])
        self.assertIn(says, self.check_device("eight", "--array", "a.toml", status=3)["cure"])


class Wiring(DevicesTest):
    """Tactors whose channels reach no channel of the device alone: with the ALSA configuration of examples/asound."""
    PCMS = """
pcm.summed { type route slave.pcm "null" ttable { 0.0 1 1.1 1 2.2 1 3.3 1 4.4 1 5.5 1 6.6 1 7.7 1 8.3 1 } }
pcm.straight { type plug slave.pcm { type copy slave.pcm "null" } }
pcm.kept { type route slave.pcm { type file slave.pcm "null" file "kept.raw" format raw } ttable { 0.0 1 } }
"""
    LOST = "tactor 8 of palm-3x3 is on channel 8, which reaches no channel of the device"

    def setUp(self):
        super().setUp()
        example = (ROOT / "examples/asound/8ch.conf").read_text(encoding="utf-8")
        self.write("alsa.conf", ALSA_CONFIG + example.replace('"hw:CARD=Tactor,DEV=0"', '"null"') + self.PCMS)

    def test_nothing_plays_where_a_tactor_is_lost(self):
        r = self.refused(3, "play", *self.STROKE, "-D", "tactor8", says=['stream on "tactor8"', self.LOST, "ttable", "hw:CARD=NAME"])
        self.assertNotIn("played", r.stdout)
        self.refused(3, "play", *self.STROKE, "-D", "summed")
        self.refused(3, "play", "--live", "-", "-D", "tactor8", stdin="0 0\n", says=[self.LOST])
        self.refused(3, "check", "--walk", "--auto", "-D", "tactor8", says=[self.LOST])
        self.ok("play", "--path", "M 0 0 L 60 0", "--duration", "0.2", "--array", "palm-2x4", "-D", "tactor8")
        self.assertNotIn("not known", self.ok("play", *self.STROKE, "-D", "straight").stderr)

    def test_check_and_devices_report_it(self):
        found = self.check_device("tactor8", status=3)
        self.assertEqual((found["level"], found["found"]), ("error", f'PCM "tactor8": {self.LOST}'))
        self.assertIn("-D hw:CARD=NAME", found["cure"])
        self.assertIn("which the PCM mixes with", self.check_device("summed", status=3)["found"])
        self.assertEqual((self.check_device("straight")["level"], self.check_device("tactor8", "--array", "palm-2x4")["level"]), ("ok", "ok"))
        self.write("kept.raw", "precious")
        self.assertIn("tactor 1 of palm-3x3", self.check_device("kept", status=3)["found"])  # though it is not opened
        self.assertEqual((self.dir / "kept.raw").read_text(), "precious")
        pcms = self.devices()[1]
        self.assertEqual((pcms["tactor8"]["fits"], pcms["tactor8"]["misfit"]), (False, self.LOST))
        self.assertEqual((pcms["straight"]["fits"], pcms["straight"]["misfit"]), (True, None))
        self.assertIn("    unfit     tactor 8 of palm-3x3 is on channel 8", self.ok("devices").stdout)

    def test_samples_that_alsa_clips_on_the_way_are_a_warning(self):
        tables = [" ".join(f"{c}.{c} {gain}" for c in range(9)) for gain in (0.5, 2)]
        self.write("alsa.conf", ALSA_CONFIG + 'pcm.half { type route slave { pcm "null" channels 9 } ttable { %s } }\n'
                   'pcm.twice { type route slave { pcm "half" channels 9 } ttable { %s } }\n' % tuple(tables)
                   + 'pcm.kept { type file slave.pcm "twice" file "kept.raw" format raw }\n')
        says = "amplifies samples by up to 6.02 dB on the way to the device, and clips them there"
        found = self.check_device("twice")
        self.assertEqual((found["level"], found["found"].count(says)), ("warning", 1))
        self.assertEqual(self.ok("play", *self.STROKE, "-D", "twice").stderr.count(says), 1)
        self.assertIn(says, self.check_device("kept")["found"])  # which is not opened


class SharedFiles(DevicesTest):
    """Array files by others: they name the device, and none of their texts writes a file or runs a command."""
    STROKE = ("--shape", "tap")
    PCMS = """
pcm.file {
    @args [ FILE FORMAT ]
    @args.FILE { type string }
    @args.FORMAT { type string default raw }
    type file
    slave.pcm { type null }
    file $FILE
    format $FORMAT
}
pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }
pcm.recorder { type file slave.pcm { type null } file "kept" format raw }
pcm.hidden { type plug slave.pcm "recorder" }
pcm.desk { type plug slave.pcm "null" }
"""
    COMMAND = "file:'|touch ran; cat >/dev/null',raw"
    # Each would write, run or define something, in another way.
    HOSTILE = (COMMAND, "file:kept,raw", "file:FILE=kept", "raw:kept", "recorder", "hidden", "plug:recorder", "plug:'recorder'",
               "{ type file slave.pcm null file kept format raw }", "plug:{ type file slave.pcm null file kept format raw }",
               "plug:\"file:'kept',raw\"", "plug:'file:\\'kept\\',raw'", "null\nfile:kept", "@x", "kept/../kept", " null")

    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + self.PCMS)
        self.write("kept", "precious")

    def array(self, pcm, name="a.toml"):
        text = pcm.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return self.write(name, GRID.replace('"null"', f'"{text}"'))

    def untouched(self):
        self.assertEqual(((self.dir / "kept").read_text(), (self.dir / "ran").exists()), ("precious", False))

    def test_an_array_file_cannot_write_or_run_anything(self):
        for pcm in self.HOSTILE:
            self.array(pcm)
            for command in (("play", *self.STROKE), ("check",), ("check", "--walk", "--auto"), ("devices",)):
                r = self.run_tool(*command, "--array", "a.toml")
                self.assertEqual((r.returncode, "a.toml:11:7: PCM" in r.stderr), (2, True), f"{pcm} {command}: {r.stderr}")
                self.untouched()
        self.array(self.COMMAND)
        out = self.refused(2, "check", "--array", "a.toml").stdout
        self.assertRegex(out, r"(?m)^error    device +a\.toml:11:7: PCM")
        self.assertRegex(out, r"(?m)^(ok|warning)  +real time ")
        for args in (("plan",), ("render", "-o", "a.wav"), ("play", "-D", "null")):
            self.ok(*args, *self.STROKE, "--array", "a.toml")
        self.array(self.COMMAND, "others/a.toml")
        self.write("mine.toml", '[array]\nfile = "others/a.toml"\n')
        self.write("between.toml", '[array]\nfile = "mine.toml"\n')
        for how in (("--array", "mine.toml"), ("--array", "between.toml"), ("--config", "mine.toml"), ("--config", "between.toml")):
            for command in ("play", *self.STROKE), ("check",):
                self.assertEqual(self.run_tool(*command, *how).returncode, 2, how)
        self.untouched()

    def test_devices_by_their_names_are_accepted(self):
        for pcm in ("null", "default", "desk", "plug:null", "plug:'null'", "plug:SLAVE=null"):
            self.array(pcm)
            self.ok("play", *self.STROKE, "--array", "a.toml")
            self.ok("check", "--array", "a.toml")
        self.array("hw:CARD=Nowhere,DEV=0")
        self.refused(3, "play", *self.STROKE, "--array", "a.toml")

    def test_the_command_line_and_the_user_s_configuration_may_name_more(self):
        self.array(f"file:'{self.dir}/out.raw',raw", "mine.toml")
        self.ok("play", *self.STROKE, "--config", "mine.toml")
        self.assertTrue((self.dir / "out.raw").stat().st_size)
        self.ok("play", *self.STROKE, "-D", f"file:'|cat >{self.dir}/piped',raw")
        self.assertTrue((self.dir / "piped").stat().st_size)
        for pcm in ("file:FILE=kept", "recorder", "hidden", self.COMMAND):  # check and devices open no file that they would empty
            self.assertRegex(self.ok("check", "-D", pcm).stdout, r"(?m)^warning  device .*not opened")
            self.assertIn("not tried", " ".join(self.ok("devices", "-D", pcm).stdout.split()).lower())
            self.untouched()
        # The file's own name wins over that of an included file.
        self.array(self.COMMAND, "others/a.toml")
        self.write("mine.toml", '[array]\nfile = "others/a.toml"\n[output]\npcm = "recorder"\n')
        self.ok("play", *self.STROKE, "--config", "mine.toml")
        self.assertNotEqual((self.dir / "kept").read_bytes(), b"precious")

    def test_a_file_that_is_no_gpio_chip_is_not_opened(self):
        os.mkfifo(self.dir / "pipe")
        for table, chip in (("[amplifier]\nline =", "pipe"), ("[sync]\nout =", "kept")):
            self.write("a.toml", GRID + f'{table} {{ chip = "{self.dir}/{chip}", offset = 1 }}\n')
            self.refused(3, "check", "--array", "a.toml")
            self.refused(3, "play", *self.STROKE, "--array", "a.toml")
        self.untouched()


class Off(ToolTest):
    """tactor off without a GPIO chip: its messages. tests/vm tests the switching on a real kernel."""

    def test_without_an_amplifier_the_files_without_one_are_named(self):
        array = self.write("palm.toml", '[array]\npreset = "palm-3x3"\n')
        config = self.write("mine.toml", '[output]\npcm = "null"\n')
        for options, says in (((), "there is no configuration"), (("--config", config), f"no [amplifier] in {config} ("),
                              (("--array", array), f"no [amplifier] in {array}, and there is no configuration ("),
                              (("--array", array, "--config", config), f"no [amplifier] in {array} or {config} ("),
                              (("--array", "palm-2x4", "--config", config), f"no [amplifier] in {config} (")):
            self.assertEqual(self.refused(2, "off", *options, says=[says]).stdout, "")

    def test_the_shown_example_has_an_amplifier(self):
        example = re.search(r"^Examples:\n  tactor (.*)", self.ok("off", "--help").stdout, re.M)[1]
        self.assertIn(f"\n.Dl tactor {example}\n", (ROOT / "man/tactor-off.1").read_text(encoding="utf-8"))
        self.write("tactor.toml", (ROOT / "examples/tactor.toml").read_bytes())
        self.refused(3, *example.split())

    def test_a_missing_chip_is_an_error(self):
        self.write("a.toml", '[array]\npreset = "palm-3x3"\n' + AMPLIFIER)
        for option in ("--config", "--array"):
            self.assertEqual(self.refused(3, "off", option, "a.toml", says=["no-such-chip"]).stdout, "")

    def test_it_takes_no_stroke(self):
        self.refused(2, "off", "park2016-1")

    def test_the_unit_in_examples_switches_off_after_its_end(self):
        unit = (ROOT / "examples/systemd/tactor-play@.service").read_text(encoding="utf-8")
        after = re.search(r"^ExecStopPost=-(\S+) off$", unit, re.M)
        self.assertEqual(after[1], re.search(r"^ExecStart=(\S+) play ", unit, re.M)[1])


if __name__ == "__main__":
    main()
