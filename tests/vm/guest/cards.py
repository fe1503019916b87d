# SPDX-License-Identifier: MIT
"""Linux's own drivers of sound cards, with cards that are emulated: by usb_card.py, and by QEMU (tests/lanes/cards).

What a card received is compared with `tactor render`, byte by byte, and the times that `play` reports with the card's own.
Prints a table at its end.
"""
import json
import os
import pathlib
import re
import statistics
import struct
import subprocess
import unittest

from rig import BUILD, RATE, RigTest, SessionTest, wait_for, wav_data
from usb_card import PACKETS_S, UsbCard

ALSA = pathlib.Path("/proc/asound")
PERIOD, PERIODS = 480, 100  # a second: the emulated machine may stand still
ROUNDS, PAUSE = 6, RATE // 5
STROKE = ("--shape", "circle", "--duration", "1")
ERROR_MS = 6  # the driver sends up to 6 ms at once, and its position moves by these
FORMATS = {16: "s16", 24: "s24", 32: "s32"}
FRAMES, KEPT = 48, 16  # frames in a packet of QEMU's card, and how many of them QEMU records
ROWS = {}


def add_row(name, report, equal, late_ms=(), still="not known"):
    device = report["device"]
    times = f"{statistics.median(late_ms):+.2f} (worst {max(late_ms, key=abs):+.2f})" if late_ms else "not known"
    ROWS[name] = (name, str(device["channels"]), device["format"], equal, str(report["counters"]["xruns"]),
                  "periods" if device["batch"] else "finer", times, still)


def load(*modules):
    kernel = re.search(r"kernel_root=(\S+)", pathlib.Path("/proc/cmdline").read_text(encoding="ascii"))[1]
    for module in modules:
        r = subprocess.run(["modprobe", "-d", kernel, module], capture_output=True, text=True, check=False)
        if r.returncode != 0:
            raise unittest.SkipTest(f"the kernel has no module {module}: {r.stderr.strip()}")


def setUpModule():
    # The driver asks for the bus's frame number, vhci-hcd prints that it has none, and a serial line is slow.
    pathlib.Path("/proc/sys/kernel/printk").write_text("1", encoding="ascii")


def tearDownModule():
    head = ("card", "channels", "format", "equal frames", "xruns", "position", "predicted - played, ms", "stood still, ms")
    rows = [head, *ROWS.values()]
    widths = [max(len(r[i]) for r in rows) for i in range(len(head))]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip())


def usb_packets(pcap):
    """Returns the bytes of each isochronous packet to the card in a file of libpcap with headers of usbmon."""
    at, packets = 24, []
    while at + 16 <= len(pcap):
        length = int.from_bytes(pcap[at + 8:at + 12], "little")
        header, data = pcap[at + 16:at + 80], pcap[at + 80:at + 16 + length]
        if header[9] == 0 and header[10] < 0x80 and data:
            packets.append(data)
        at += 16 + length
    return packets


def first_sound(data):
    """Returns the place of the first byte that is not 0."""
    found = re.search(rb"[^\0]", data)
    if not found:
        raise AssertionError(f"{len(data)} bytes of silence")
    return found.start()


def repeat(rendered, frame):
    """Returns the rounds of a stroke, with the pauses between them."""
    return bytes(PAUSE * frame).join([rendered] * ROUNDS)


def count_equal(got, wanted, frame):
    if got == wanted:
        return len(got) // frame
    return sum(got[i:i + frame] == wanted[i:i + frame] for i in range(0, len(got), frame))


class CardTest(RigTest):
    def array(self, card, channels, extra=""):
        return self.grid(channels, extra, f"hw:CARD={card}", PERIOD, PERIODS)

    def preset(self, name, card):
        return self.write(f"{name}.toml", f'[array]\npreset = "{name}"\n[output]\npcm = "hw:CARD={card}"\nperiod_frames = {PERIOD}\nperiods = {PERIODS}\n')

    def render(self, array, sample_format, *stroke):
        r = self.tool("render", *stroke, "--array", array, "--sample-format", sample_format, "-o", "o.wav")
        self.assertEqual(r.returncode, 0, r.stderr)
        return wav_data(self.dir / "o.wav")

    def play(self, array, *stroke):
        """Plays the rounds; returns the report, and when each began: CLOCK_MONOTONIC, in s."""
        r = self.tool("play", *stroke, "--array", array, "--repeat", ROUNDS, "--pause", PAUSE / RATE, "--verbose", "--format", "json")
        self.assertEqual(r.returncode, 0, r.stderr)
        report = json.loads(r.stdout)
        self.assertEqual(report["counters"]["xruns"], 0, r.stderr)
        began = [float(t) for t in re.findall(r"\((\d+\.\d+) s by CLOCK_MONOTONIC\), finished", r.stderr)]
        self.assertEqual(len(began), ROUNDS, r.stderr)
        return report, began

    def find(self, pcm, array, channels, sample_format, preset=None):
        """Checks what `tactor devices` and `tactor check` find."""
        r = self.tool("devices", "--array", array, "--format", "json")
        card = next(p for p in json.loads(r.stdout)["pcms"] if p["name"] == f"{pcm},DEV=0")
        self.assertEqual((card["hardware"], card["configured"], card["fits"], card["holders"]), (True, True, True, []), card)
        self.assertEqual(card["preset"], preset)
        self.assertIn(channels, [c["max"] for c in card["can"]["channels"]])
        self.assertIn(sample_format, card["can"]["formats"])
        r = self.tool("check", "--array", array, "--format", "json")
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        found = {f["check"]: f for f in json.loads(r.stdout)["findings"]}
        self.assertEqual(found["device"]["level"], "ok", found)
        self.assertIn(f"{channels} channels, {RATE} Hz", found["device"]["found"])


class UsbTest(CardTest):
    """Cards in software, by the driver snd-usb-audio."""

    def setUp(self):
        super().setUp()
        load("vhci-hcd", "snd-usb-audio")

    def plug_in(self, *shape, known_as=None, **behaviour):
        """Plugs a card in. `known_as`: ALSA's name for it, if that is not the product's."""
        card = UsbCard(*shape, **behaviour)
        card.id = known_as or card.name
        card.plug_in()
        self.addCleanup(self.pull_out, card)
        wait_for(lambda: os.path.exists(ALSA / card.id), "the card")
        return card

    def pull_out(self, card):
        card.pull_out()
        wait_for(lambda: not os.path.exists(ALSA / card.id), "no card")  # Path.exists fails on an entry that is going away


class UsbCards(UsbTest):
    def compare(self, card, bits, name=None):
        """Plays rounds; checks each byte, and the times."""
        array = self.array(card.name, card.channels)
        rendered = self.render(array, FORMATS[bits], *STROKE)
        report, began = self.play(array, *STROKE)
        data, frame = bytes(card.data), card.frame
        start = first_sound(data) // frame - first_sound(rendered) // frame
        strokes = bytes(start * frame) + repeat(rendered, frame)
        step = len(rendered) // frame + PAUSE
        played = [card.find_time(start + i * step) for i in range(ROUNDS)]
        late_ms = [1e3 * (t - p) for t, p in zip(began, played)]
        still_ms = 1e3 * (played[-1] - played[0] - (ROUNDS - 1) * step * card.frame_s)
        equal = count_equal(data, strokes.ljust(len(data), b"\0"), frame)
        add_row(name or card.name, report, f"{equal} of {len(data) // frame}", late_ms, f"{still_ms:.0f}")
        self.assertEqual(report["device"]["format"], FORMATS[bits])
        self.assertGreaterEqual(len(data), len(strokes))
        self.assertEqual(equal, len(data) // frame)
        # No clock predicts when the emulated machine stands still.
        self.assertLess(statistics.median(map(abs, late_ms)), ERROR_MS + still_ms + 1e3 * card.jitter_s)

    def test_each_format_arrives_byte_by_byte(self):
        for channels, bits in ((24, 32), (16, 24), (16, 32), (8, 16), (8, 24)):
            with self.subTest(channels=channels, bits=bits):
                card = self.plug_in(channels, bits)
                self.find(f"hw:CARD={card.name}", self.array(card.name, channels), channels, FORMATS[bits])
                self.compare(card, bits)

    def test_a_clock_that_is_off(self):
        for ppm in (50, -500, 2000):
            with self.subTest(ppm=ppm):
                card = self.plug_in(8, 16, ppm=ppm)
                self.compare(card, 16, f"{card.name}, {ppm:+} ppm")
                self.pull_out(card)

    def test_a_card_that_tells_its_clock(self):
        for ppm in (-500, 2000):
            with self.subTest(ppm=ppm):
                card = self.plug_in(8, 16, ppm=ppm, feedback=True)
                self.compare(card, 16, f"{card.name}, feedback of {ppm:+} ppm")
                followed_ppm = 1e6 * (len(card.data) / card.frame / card.packets * PACKETS_S / RATE - 1)
                print(f"the driver followed {followed_ppm:+.0f} ppm")
                self.assertAlmostEqual(followed_ppm, ppm, delta=200)
                self.pull_out(card)

    def test_a_card_that_answers_irregularly(self):
        card = self.plug_in(8, 16, ppm=-500, jitter_s=0.004)
        self.compare(card, 16, f"{card.name}, -500 ppm, answers up to 4 ms late")

    def test_a_card_that_stands_still_for_a_moment(self):
        card = self.plug_in(8, 16, pause=(2 * RATE, 0.03))
        self.compare(card, 16, f"{card.name}, stands still for 30 ms")
        self.assertIsNone(card.pause)


class UsbSessions(UsbTest, SessionTest):
    """A study on a card, with a marker and the codes of its events on channels of their own."""

    TACTORS, MARKER, CODE = 9, 9, 10
    BIT, LEAD = RATE * 2 // 1000, 9 * RATE * 2 // 1000
    STIMULUS, ANSWER, TRIALS = 0x81, 0x42, 4

    def test_marker_code_and_stimulus_arrive_together(self):
        card = self.plug_in(16, 32)
        array = self.grid(self.TACTORS, f"[sync]\nchannel = {self.MARKER}\ncode = {{ channel = {self.CODE} }}\n[sync.codes]\n"
                          f"stimulus = {self.STIMULUS}\nanswer = {self.ANSWER - 1}\nvoid = 2\n", f"hw:CARD={card.name}", PERIOD, PERIODS)
        run = f'[[run]]\nname = "ratings"\ntask = "rate"\nattribute = "similarity"\ntrials = {self.TRIALS}\nscale = 3\n'
        self.hold(self.HEAD + run, "y\n" * self.TACTORS + "\n" + "2\n" * 3 * self.TRIALS, timeout=300)
        samples = struct.unpack(f"<{len(card.data) // 4}i", card.data)
        got = [samples[c::card.channels] for c in range(card.channels)]
        code, found, at = got[self.CODE], [], 0
        while at < len(code) - self.LEAD:
            if code[at]:
                found.append((at + self.LEAD, sum((code[at + (i + 1) * self.BIT + self.BIT // 2] > 0) << i for i in range(8))))
                at += self.LEAD
            at += 1
        rows = [r for r in self.table("ratings") if r["void"] == "false"]
        self.assertEqual(len(rows), self.TRIALS)
        answers = [n for _, n in found if n == self.ANSWER]
        self.assertEqual(len(answers), self.TRIALS)
        starts = [at for at, n in found if n == self.STIMULUS]
        self.assertGreaterEqual(len(starts), self.TRIALS)
        for at in starts:
            self.assertEqual((got[self.MARKER][at - 1], got[self.MARKER][at] > 0), (0, True))
        whole = self.rendered(rows[0]["plan_1"], array)
        channels = max(self.MARKER, self.CODE) + 1
        wanted = struct.unpack(f"<{len(whole) // 4}i", whole)
        frames = len(wanted) // channels
        equal = sum(all(got[c][at:at + frames] == wanted[c::channels] for c in range(self.TACTORS)) for at in starts)
        print(f"{equal} of {len(starts)} stimuli of a study arrived whole, at the frame of marker and code")
        self.assertGreaterEqual(equal, self.TRIALS)


class QemuCards(CardTest):
    """QEMU's own cards, which tests/lanes/cards adds to the machine."""

    def find_controller(self, pci_class, *modules):
        if not any(f.read_text(encoding="ascii").startswith(pci_class) for f in pathlib.Path("/sys/bus/pci/devices").glob("*/class")):
            self.skipTest("tests/lanes/cards adds this card to the machine")
        load(*modules)

    @staticmethod
    def recorded():
        # The file has grown since the guest looked at it.
        pathlib.Path("/proc/sys/vm/drop_caches").write_text("3", encoding="ascii")
        return usb_packets((BUILD / "cards/usb.pcap").read_bytes())

    def test_eight_channels_by_usb_arrive_byte_by_byte(self):
        self.find_controller("0x0c0330", "xhci-pci", "snd-usb-audio")
        wait_for(lambda: (ALSA / "Audio").exists(), "the card")
        for name in ("vm", "usb-7.1"):
            with self.subTest(array=name):
                self.compare(name, self.array("Audio", 8) if name == "vm" else self.preset(name, "Audio"))

    def compare(self, name, array):
        self.find("hw:CARD=Audio", array, 8, "s16", preset="usb-7.1")
        frame, whole = 16, FRAMES * 16
        sound = self.render(array, "s16", *STROKE)
        sound = repeat(sound, frame)[first_sound(sound) // frame * frame:]
        before = len(self.recorded())
        report, _ = self.play(array, *STROKE)
        packets = self.recorded()[before:]
        first = next(i for i, p in enumerate(packets) if any(p))

        def count_packets(start, packets):
            wanted = (bytes(start * frame) + sound).ljust(len(packets) * whole, b"\0")
            return sum(p == wanted[i * whole:i * whole + len(p)] for i, p in enumerate(packets))
        # The sound may begin in frames that are not recorded.
        starts = range(FRAMES * first - FRAMES + KEPT, FRAMES * first + KEPT)
        start = max(starts, key=lambda s: count_packets(s, packets[:first + 20]))
        equal = count_packets(start, packets)
        add_row(f"QEMU's usb-audio, {name}", report, f"{KEPT * equal} of {KEPT * len(packets)}")
        self.assertEqual({len(p) for p in packets}, {KEPT * frame})
        self.assertEqual(equal, len(packets))

    def test_a_stereo_card_by_hda(self):
        self.find_controller("0x040300", "snd-hda-codec-generic", "snd-hda-intel")
        wait_for(lambda: (ALSA / "Intel").exists(), "the card")
        array = self.array("Intel", 2)
        report, _ = self.play(array, "--path", "M 0 0 H 20", "--duration", "1")
        add_row("QEMU's hda-output", report, "not recorded")
