# SPDX-License-Identifier: MIT
"""tactor render: the WAV file against the signal computed here from the plan, and the fate of the file."""
import cmath
import math
import os
import pathlib
import resource
import signal
import subprocess
import unittest

from harness import PATIENCE_S, SANITIZED, TOOL, ToolTest, Wav, main

LEVEL = 10 ** (-12 / 20)
FORMATS = {"float": (3, 32), "s16": (1, 16), "s24": (1, 24), "s32": (1, 32)}


def expected(plan, channels, rate=48000, carrier=250.0, level=LEVEL, restart=False):
    """Computes the signal section by section: bursts that do not overlap, no ramp."""
    frames = round(plan["total_s"] * rate)
    out = [[0.0] * channels for _ in range(frames)]
    for b in plan["bursts"]:
        first = math.floor(b["onset_s"] * rate + 0.5)
        last = math.floor((b["onset_s"] + b["duration_s"]) * rate + 0.5)
        for k in range(last - first):
            s = level * math.sin(2 * math.pi * carrier * (k if restart else first + k) / rate)
            for d in b["drives"]:
                out[first + k][d["channel"]] += d["amplitude"] * s
    return out


class Samples(ToolTest):
    def compare(self, wav, reference, tolerance):
        got = wav.samples()
        self.assertEqual(len(got), len(reference))
        worst = max(abs(a - b) for x, y in zip(got, reference) for a, b in zip(x, y))
        self.assertLessEqual(worst, tolerance)

    def test_a_preset_matches_the_paper_in_every_format(self):
        reference = expected(self.plan("park2016-1"), 9)
        for name, (tag, bits) in FORMATS.items():
            self.ok("render", "park2016-1", "--sample-format", name, "-o", "o.wav")
            wav = Wav(self.dir / "o.wav")
            self.assertEqual((wav.tag, wav.bits, wav.channels, wav.rate, wav.frames), (tag, bits, 9, 48000, 70560))
            # Half a step of the format, and the precision of a float.
            self.compare(wav, reference, 0.5000001 / 2 ** (bits - 1) if tag == 1 else 2e-8)

    def test_a_marker_channel_is_high_for_5_ms_from_each_strokes_first_frame(self):
        self.write("a.toml", '[array]\nname = "pair"\ngrid = { rows = 1, columns = 2, pitch_mm = 10 }\n'
                             '[sync]\nchannel = 3\n')
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 10 0"\nduration_s = 0.5\n'
                               '[[stroke]]\npath = "M 10 0 L 0 0"\nduration_s = 0.5\nstart_s = 0.75\n')
        self.ok("render", "two.toml", "--array", "a.toml", "--sample-format", "s16", "-o", "o.wav")
        wav = Wav(self.dir / "o.wav")
        self.assertEqual(wav.channels, 4)
        high = [n for n, f in enumerate(wav.samples()) if f[3] != 0]
        self.assertEqual(high, list(range(240)) + list(range(36000, 36240)))
        self.assertTrue(all(f[3] > 0.9999 and f[2] == 0 for n, f in enumerate(wav.samples()) if n in set(high)))

    def test_the_largest_array_is_planned_rendered_and_played(self):
        self.write("large.toml", '[array]\nname = "large"\ngrid = { rows = 32, columns = 32, pitch_mm = 2 }\n')
        stroke = ("--array", "large.toml", "--path", "M 0 0 L 4 4", "--duration", "0.1")
        self.ok("plan", *stroke)
        self.ok("render", *stroke, "--sample-format", "float", "-o", "large.wav")
        self.assertEqual(Wav(self.dir / "large.wav").channels, 1024)
        self.ok("play", *stroke, "-D", "null")

    def test_level_gain_polarity_and_map_reach_their_channel(self):
        self.write("a.toml", '[array]\nname = "pair"\n'
                             '[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\nchannel = 2\ngain_db = -6.0\npolarity = -1\n'
                             '[[tactor]]\nx_mm = 10.0\ny_mm = 0.0\nchannel = 0\n')
        self.ok("render", "--path", "M 0 0 L 10 0", "--duration", "1", "--array", "a.toml", "--level-dbfs", "-6",
                "-o", "o.wav")
        wav = Wav(self.dir / "o.wav")
        self.assertEqual(wav.channels, 3)
        got = wav.samples()
        self.assertTrue(all(f[1] == 0 for f in got))
        quarter = 48  # of a cycle at 250 Hz
        self.assertAlmostEqual(got[quarter][2], -(10 ** (-12 / 20)), 5)
        last = max(abs(f[0]) for f in got)
        self.assertAlmostEqual(last, 10 ** (-6 / 20) * math.sqrt(14 * 0.07), 4)

    def test_sensation_level_adds_to_the_threshold(self):
        self.write("a.toml", '[array]\nname = "one"\n[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\nthreshold_dbfs = -41.5\n')
        self.write("s.csv", "t_s,x_mm,y_mm\n0,0,0\n1,0,0\n")
        self.ok("render", "s.csv", "--array", "a.toml", "--sl", "7", "-o", "o.wav")
        peak = max(abs(f[0]) for f in Wav(self.dir / "o.wav").samples())
        self.assertAlmostEqual(peak, 10 ** ((-41.5 + 7) / 20), 6)

    def test_ramps_and_phase_can_be_chosen(self):
        self.ok("render", "park2016-1", "--ramp", "0.005", "-o", "o.wav")
        got = Wav(self.dir / "o.wav").samples()
        plain = expected(self.plan("park2016-1"), 9)
        for k in (24, 120, 216):
            w = 0.5 * (1 - math.cos(math.pi * k / 240))
            self.assertAlmostEqual(got[k][1], plain[k][1] * w, 6)
        for phase in ("stroke", "burst"):
            self.ok("render", "park2016-1", "--carrier", "255", "--phase", phase, "--ramp", "0", "-o", "o.wav")
            self.compare(Wav(self.dir / "o.wav"), expected(self.plan("park2016-1"), 9, carrier=255.0,
                                                           restart=phase == "burst"), 2e-8)

    def test_a_tactor_in_several_bursts_in_a_row_vibrates_at_the_carrier_only(self):
        self.write("s.csv", "t_s,x_mm,y_mm\n0,20,20\n2.73,20,20\n")
        def lines(phase):
            self.ok("render", "s.csv", "--rate", "8000", *phase, "-o", "o.wav")
            x = [f[4] / LEVEL for f in Wav(self.dir / "o.wav").samples()]
            self.assertEqual(len(x), 22400)
            at = [2 * abs(sum(v * cmath.exp(-2j * math.pi * hz * k / 8000) for k, v in enumerate(x))) / len(x)
                  for hz in (250.0, 250.0 - 1 / 0.14, 250.0 + 1 / 0.14)]
            return at, sum(x) / len(x)
        (carrier, *sides), mean = lines([])
        self.assertAlmostEqual(carrier, 1.0, 5)
        self.assertLess(max(sides), 1e-4)
        self.assertLess(abs(mean), 1e-8)
        (carrier, *sides), mean = lines(["--phase", "burst"])
        self.assertLess(carrier, 0.03)
        self.assertGreater(min(sides), 0.6)
        self.assertGreater(mean, 0.01)
        self.refused(2, "render", "s.csv", "--phase", "continuous", "-o", "o.wav")

    def test_overlapping_bursts_on_one_tactor_stay_within_the_level(self):
        self.ok("render", "park2016-3", "--algorithm", "tactile-brush", "-o", "o.wav")
        peak = max(abs(v) for f in Wav(self.dir / "o.wav").samples() for v in f)
        self.assertLessEqual(peak, LEVEL * (1 + 1e-6))
        self.assertGreater(peak, LEVEL * 0.8)

    def test_strokes_of_a_file_are_mixed_at_their_times(self):
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
                               '[[stroke]]\nstart_s = 0.35\npath = "M 0 40 L 40 40"\nduration_s = 0.7\n')
        self.ok("render", "two.toml", "-o", "o.wav")
        got = Wav(self.dir / "o.wav").samples()
        self.assertEqual(len(got), round((0.35 + 0.77) * 48000))
        self.assertTrue(all(v == 0 for f in got[:16800] for v in f[6:]))
        self.assertNotEqual(got[16800 + 48][6], 0)
        self.assertNotEqual(got[16800 + 48][1], 0)

    def test_the_bytes_do_not_depend_on_the_locale_or_the_run(self):
        seen = set()
        for locale in ("C", "de_DE.UTF-8", "fr_FR.UTF-8", "C"):
            self.ok("render", "park2016-2", "-o", "o.wav", env={"LC_ALL": locale})
            seen.add((self.dir / "o.wav").read_bytes())
        self.assertEqual(len(seen), 1)


class Files(ToolTest):
    # A day's; with sanitizers planning it took half a minute.
    LONG = ("render", "--path", "M 0 10 L 40 30", "--duration", "3600" if SANITIZED else "86400", "-o", "long.wav")

    def leftovers(self):
        return sorted(p.name for p in self.dir.iterdir() if p.name not in ("alsa.conf",))

    def test_a_failed_render_leaves_no_file_and_an_old_one_alone(self):
        self.write("o.wav", "old")
        self.refused(2, "render", "--path", "M 0 -50 L 40 -50", "-o", "o.wav")
        self.assertEqual((self.dir / "o.wav").read_text(), "old")
        self.refused(2, "render", "park2016-1", "-o", "missing/o.wav")
        (self.dir / "folder").mkdir()
        self.run_tool("render", "park2016-1", "-o", "folder")
        self.assertEqual(self.leftovers(), ["folder", "o.wav"])
        self.assertEqual(list((self.dir / "folder").iterdir()), [])

    def test_a_disk_that_fills_up_is_reported_and_cleaned(self):
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        r = subprocess.run([TOOL, "render", "park2016-1", "-o", "o.wav"], cwd=self.dir, env=self.env, text=True,
                           capture_output=True, preexec_fn=small_files, check=False)
        self.assertEqual(r.returncode, 1, r.stderr)
        self.assertIn("o.wav", r.stderr)
        self.assertEqual(self.leftovers(), [])

    def test_ctrl_c_ends_a_long_render_and_leaves_nothing(self):
        process = subprocess.Popen([TOOL, *self.LONG], cwd=self.dir, env=self.env, stderr=subprocess.PIPE, text=True)
        self.until(self.leftovers, process)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(self.leftovers(), [])

    @unittest.skipIf(SANITIZED, "a sanitizer keeps freed memory for a while")
    def test_memory_does_not_grow_with_the_length(self):
        def peak(seconds):
            code = ("import resource,subprocess,sys;"
                    "r=subprocess.run(sys.argv[1:],stdout=subprocess.DEVNULL).returncode;"
                    "print(r,resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
            out = subprocess.run(["python3", "-c", code, TOOL, "render", "--path", "M 0 10 L 40 30", "--duration",
                                  str(seconds), "--algorithm", "continuous", "--rate", "8000", "-o", "m.wav"],
                                 cwd=self.dir, env=self.env, capture_output=True, text=True, check=True).stdout
            status, kilobytes = map(int, out.split())
            self.assertEqual(status, 0)
            return kilobytes
        self.assertLess(peak(3600), peak(1) + 4096)

    def test_the_output_file_has_ordinary_rights(self):
        self.ok("render", "park2016-1", "-o", "o.wav")
        mask = os.umask(0)
        os.umask(mask)
        self.assertEqual(pathlib.Path(self.dir / "o.wav").stat().st_mode & 0o777, 0o666 & ~mask)


if __name__ == "__main__":
    main()
