# SPDX-License-Identifier: MIT
"""A tactor whose channel reaches no channel of the device alone: with the ALSA configuration of examples/asound."""
import json

from harness import ALSA_CONFIG, ROOT, ToolTest, main

EIGHT = (ROOT / "examples/asound/8ch.conf").read_text(encoding="utf-8")
MORE_PCMS = """
pcm.summed { type route slave.pcm "null" ttable { 0.0 1 1.1 1 2.2 1 3.3 1 4.4 1 5.5 1 6.6 1 7.7 1 8.3 1 } }
pcm.straight { type plug slave.pcm { type copy slave.pcm "null" } }
pcm.named { type route slave.pcm "null" ttable { 0.FL 1 1.FR 1 2.RL 1 3.RR 1 4.FC 1 5.LFE 1 6.SL 1 7.SR 1 8.RC 1 } }
pcm.kept { type route slave.pcm { type file slave.pcm "null" file "kept.raw" format raw } ttable { 0.0 1 } }
"""
GAINS = """
pcm.quiet { type route slave { pcm "null" channels 10 } ttable { 0.0 0.1 1.1 1 2.2 -1 3.3 1 4.4 1 5.5 1 6.6 1 7.7 1 8.8 0.5 8.9 1 } }
pcm.loud { type route slave.pcm "null" ttable { 0.0 1 1.1 2 2.2 1 3.3 1 4.4 1 5.5 1 6.6 1 7.7 1 8.8 1 } }
pcm.below { type route slave.pcm "null" ttable { 0.0 1 1.1 1 2.2 1 3.3 1 4.4 1 5.5 1 6.6 1 7.7 1 8.8 0.00001 } }
pcm.soft { type softvol slave.pcm "null" control { name "Soft" card 0 } }
"""
LOST = "tactor 8 of palm-3x3 is on channel 8, which reaches no channel of the device"


class Wiring(ToolTest):
    STROKE = ("--path", "M 20 40 L 40 40", "--duration", "0.2")  # from tactor 7 to 8

    def setUp(self):
        super().setUp()
        eight = EIGHT.replace('"hw:CARD=Tactor,DEV=0"', '"null"')
        self.assertNotEqual(eight, EIGHT)
        self.write("alsa.conf", ALSA_CONFIG + eight + MORE_PCMS + GAINS)

    def device(self, pcm, *args, status=0):
        r = self.run_tool("check", "--format", "json", "-D", pcm, *args)
        self.assertEqual(r.returncode, status, r.stdout + r.stderr)
        return next(f for f in json.loads(r.stdout)["findings"] if f["check"] == "device")

    def test_nothing_plays_where_a_tactor_is_lost(self):
        r = self.refused(3, "play", *self.STROKE, "-D", "tactor8", says=['stream on "tactor8"', LOST, "ttable", "hw:CARD=NAME"])
        self.assertNotIn("played", r.stdout)
        self.refused(3, "play", *self.STROKE, "-D", "summed")
        self.ok("play", "--path", "M 0 0 L 60 0", "--duration", "0.2", "--array", "palm-2x4", "-D", "tactor8")
        self.assertNotIn("not known", self.ok("play", *self.STROKE, "-D", "straight").stderr)

    def test_live_strokes_and_a_walk_are_refused_too(self):
        self.refused(3, "play", "--live", "-", "-D", "tactor8", stdin="0 0\n", says=[LOST])
        self.refused(3, "check", "--walk", "--auto", "-D", "tactor8", says=[LOST])

    def test_check_reports_it(self):
        found = self.device("tactor8", status=3)
        self.assertEqual((found["level"], found["found"]), ("error", f'PCM "tactor8": {LOST}'))
        self.assertIn("-D hw:CARD=NAME", found["cure"])
        self.assertIn("together with", self.device("summed", status=3)["found"])
        self.assertEqual(self.device("straight")["level"], "ok")
        self.assertEqual(self.device("tactor8", "--array", "palm-2x4")["level"], "ok")

    def test_a_refused_pcm_is_examined_all_the_same(self):
        self.write("kept.raw", "precious")
        self.assertIn("tactor 1 of palm-3x3", self.device("kept", status=3)["found"])
        self.assertEqual((self.dir / "kept.raw").read_text(), "precious")

    def test_devices_reports_that_it_does_not_fit(self):
        pcms = {p["name"]: p for p in json.loads(self.ok("devices", "--format", "json").stdout)["pcms"]}
        self.assertEqual((pcms["tactor8"]["fits"], pcms["tactor8"]["misfit"]), (False, LOST))
        self.assertEqual((pcms["straight"]["fits"], pcms["straight"]["misfit"]), (True, None))
        self.assertIn("    unfit     tactor 8 of palm-3x3 is on channel 8", self.ok("devices").stdout)

    def test_a_level_changed_by_alsa_is_reported_and_a_louder_one_refused(self):
        said = ("tactor 0 of palm-3x3 is on channel 0, which ALSA's configuration plays at -20 dB",
                "tactor 2 of palm-3x3 is on channel 2, which ALSA's configuration plays at 0 dB with its polarity reversed",
                "tactor 8 of palm-3x3 is on channel 8, which reaches 2 channels of the device, at -6.02 dB, 0 dB")
        found = self.device("quiet")
        self.assertEqual(found["level"], "warning")
        self.assertIn("ttable", found["cure"])
        r = self.ok("play", *self.STROKE, "-D", "quiet")
        for text in said:
            self.assertIn(text, found["found"])
            self.assertIn(f"tactor: warning: {text} (", r.stderr)
        self.assertEqual(found["found"].count("tactor "), 3)
        louder = "tactor 1 of palm-3x3 is on channel 1, which ALSA's configuration plays at 6.02 dB: louder than its limit allows"
        self.assertIn(louder, self.device("loud", status=3)["found"])
        self.refused(3, "play", *self.STROKE, "-D", "loud", says=[louder])
        pcms = {p["name"]: p for p in json.loads(self.ok("devices", "--format", "json").stdout)["pcms"]}
        self.assertEqual((pcms["loud"]["fits"], pcms["loud"]["misfit"]), (False, louder))

    def test_samples_that_alsa_clips_on_the_way_are_a_warning(self):
        tables = [" ".join(f"{c}.{c} {gain}" for c in range(9)) for gain in (0.5, 2)]
        self.write("alsa.conf", ALSA_CONFIG + 'pcm.half { type route slave { pcm "null" channels 9 } ttable { %s } }\n'
                   'pcm.twice { type route slave { pcm "half" channels 9 } ttable { %s } }\n' % tuple(tables)
                   + 'pcm.kept { type file slave.pcm "twice" file "kept.raw" format raw }\n')
        says = "raises samples by up to 6.02 dB on the way to the device, and clips them there"
        found = self.device("twice")
        self.assertEqual((found["level"], found["found"].count(says)), ("warning", 1))
        self.assertEqual(self.ok("play", *self.STROKE, "-D", "twice").stderr.count(says), 1)
        self.assertIn(says, self.device("kept")["found"])  # which is not opened

    def test_below_60_db_a_tactor_is_lost(self):
        self.assertIn(LOST, self.device("below", status=3)["found"])
        self.refused(3, "play", *self.STROKE, "-D", "below", says=[LOST])

    def test_unknown_wiring_is_a_warning(self):
        note = "not known: type route to a channel FL is between"
        found = self.device("named")
        self.assertEqual(found["level"], "warning")
        self.assertIn(note, found["found"])
        self.assertTrue(found["cure"])
        r = self.ok("play", *self.STROKE, "-D", "named")
        self.assertIn("played", r.stdout)
        self.assertIn(f"tactor: warning: whether each tactor has a channel of the device to itself is {note}", r.stderr)
        self.assertIn(note.removeprefix("not known: "), self.ok("play", *self.STROKE, "-D", "named", "--verbose").stderr)


if __name__ == "__main__":
    main()
