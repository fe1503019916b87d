# SPDX-License-Identifier: MIT
"""The units of `tactor serve` under systemd: start, end, and the state in between."""
import json
import os
import pathlib
import signal
import subprocess
import unittest

from rig import PERIOD, PERIODS, Card, GpioSim, wait_for
from test_service import LONG, Client

SOCKET = "/run/tactor.sock"
LINE = 2
CARD = "sys-devices-platform-snd_aloop.0-sound-card0.device"
UNITS = pathlib.Path("/usr/local/lib/systemd")
RULES = pathlib.Path("/usr/local/lib/udev/rules.d/70-tactor.rules")


def run(*args, check=True):
    r = subprocess.run(list(map(str, args)), capture_output=True, text=True, timeout=120, check=False)
    if check and r.returncode != 0:
        raise AssertionError(f"{args}: status {r.returncode}: {r.stdout}{r.stderr}")
    return r.stdout


def systemctl(*args, check=True):
    return run("systemctl", *args, check=check)


def shows(name, unit="tactor.service"):
    return systemctl("show", "--value", "-p", name, unit).strip()


def said(*args):
    """Returns the service's entries of the journal, oldest first: (priority, text)."""
    lines = run("journalctl", "-o", "json", "-u", "tactor.service", *args).splitlines()
    return [(int(entry["PRIORITY"]), entry["MESSAGE"]) for entry in map(json.loads, lines)]


def main_pid():
    return int(shows("MainPID"))


def switched_off():
    return [text for _, text in said() if text.startswith("amplifier: line ") and text.endswith(" is off")]


def setUpModule():
    run("systemd-sysusers")
    run("modprobe", "irq_sim")
    run("modprobe", "gpio-sim")
    # The card gets the name of the rule's own example.
    ours = RULES.read_text().replace("sndrpihifiberry", "Loopback").replace('#SUBSYSTEM=="sound", KERNEL=="card[0-9]*", ATTR{id}',
                                                                         'SUBSYSTEM=="sound", KERNEL=="card[0-9]*", ATTR{id}')
    pathlib.Path("/etc/udev/rules.d/70-tactor.rules").write_text(ours)
    run("udevadm", "control", "--reload")
    Units.gpio = GpioSim()
    pathlib.Path("/etc/tactor").mkdir(exist_ok=True)  # it may be tried again
    # An emulated machine has little time to spare: few frames.
    pathlib.Path("/etc/tactor/tactor.toml").write_text(f"""
[array]
name = "vm"
grid = {{ rows = 3, columns = 3, pitch_mm = 20.0 }}
[output]
pcm = "hw:CARD=Tactor,DEV=0,SUBDEV=0"
rate = 8000
period_frames = {PERIOD}
periods = {PERIODS}
[amplifier]
line = {{ chip = "{Units.gpio.label}", offset = {LINE} }}
""")
    # The emulated machine stands still at times, and systemd would end a unit that does not settle in that time.
    own = pathlib.Path("/etc/systemd/system/tactor.service.d")
    own.mkdir(exist_ok=True)
    (own / "slow.conf").write_text("[Service]\nLimitRTTIME=infinity\n")
    systemctl("daemon-reload")


class Units(unittest.TestCase):
    """Runs in the order of names: the first test begins on a machine that has never seen a sound card."""
    gpio = None

    def setUp(self):
        self.addCleanup(self.show_why)
        if Card.DRIVER.exists():
            Card.plug_in()

    def show_why(self):
        outcome = self._outcome.result
        if any(test is self for test, _ in outcome.failures + outcome.errors):
            print(run("journalctl", "-b", "-n", "40", "--no-pager", "-o", "short-monotonic", "-u", "tactor.*"))
            print(systemctl("status", "tactor.service", "tactor.socket", check=False))

    def on(self):
        return self.gpio.value(LINE) == 1

    def client(self, path=SOCKET):
        c = Client(path)
        self.addCleanup(c.close)
        return c

    def playing(self, path=SOCKET):
        """Makes a client that has the stream's events, and its sounding stroke."""
        c = self.client(path)
        c.call("subscribe", events=["stream"])
        wait_for(lambda: c.call("status")["stream"]["state"] == "running", "the stream runs")
        return c, self.sounds(c)

    def sounds(self, c):
        number = c.call("play", **LONG)["stroke"]
        self.assertTrue(c.hear("stroke", stroke=number, state="started"))
        self.assertTrue(self.on())
        return number

    def off(self, after, seconds=5):
        wait_for(lambda: not self.on(), f"the amplifier is off after {after}", seconds)

    def comes_back(self, c, pid):
        """Checks that the client is cut off without an end of its stroke, and that the next one draws through a new process."""
        self.assertFalse(c.hear("stroke", state="finished"))
        again, _ = self.playing()
        self.assertNotEqual(main_pid(), pid)
        return again

    def test_1_the_first_client_starts_it_and_a_card_that_comes_later_is_played_on(self):
        systemctl("enable", "--now", "tactor.socket")
        self.assertEqual(shows("ActiveState"), "inactive")
        self.assertFalse(pathlib.Path("/proc/asound/cards").exists(), "sound is there before its time")
        c = self.client()
        c.call("subscribe", events=["stream"])
        self.assertEqual(c.call("status")["stream"]["state"], "lost")
        status = shows("StatusText")
        run("modprobe", "snd-aloop", "index=0", "pcm_substreams=4")
        self.assertTrue(c.hear("stream", state="running"))
        self.sounds(c)
        self.assertEqual(pathlib.Path(f"/proc/{main_pid()}").owner(), "tactor")
        self.assertIn("stream: lost: ", status)

    def test_2_a_card_that_goes_and_comes_back(self):
        c, number = self.playing()
        pid = main_pid()
        pull = Card.pull_out()
        self.assertTrue(c.hear("stroke", stroke=number, state="interrupted"))
        self.off("the card went")
        self.assertTrue(c.hear("stream", state="lost"))
        pull.wait(20)
        wait_for(lambda: "stream: lost" in shows("StatusText"), "the status says so")
        c.told.clear()
        Card.plug_in()
        self.assertTrue(c.hear("stream", state="running"))
        self.sounds(c)
        self.assertEqual(main_pid(), pid)
        self.assertEqual(shows("StatusText"), "stream: running")

    def test_3_the_journal_has_its_events(self):
        lost = [priority for priority, text in said() if "the stream is lost: " in text]
        self.assertEqual(set(lost), {4})
        again = [priority for priority, text in said() if "the stream runs again" in text]
        self.assertEqual(set(again), {6})
        ended = [priority for priority, text in said() if "the stream has ended: " in text]
        self.assertEqual(set(ended), {3})
        bad = {text for _, text in said("-p", "warning")}
        self.assertFalse({text for text in bad if "listening" in text or "runs again" in text}, bad)

    def test_4_the_process_is_killed(self):
        c, _ = self.playing()
        pid = main_pid()
        os.kill(pid, signal.SIGKILL)
        self.off("SIGKILL")
        self.comes_back(c, pid)

    def test_5_all_its_processes_are_killed(self):
        # Left alone, this line is high: a stand-in for chips that keep their last state.
        c, _ = self.playing()
        pid = main_pid()
        self.gpio.pull(LINE, True)
        self.addCleanup(self.gpio.pull, LINE, False)
        before = len(switched_off())
        systemctl("kill", "-s", "KILL", "tactor.service")
        self.off("SIGKILL of all", 60)  # it takes a process to be started, and the machine is slow
        wait_for(lambda: len(switched_off()) > before, "ExecStopPost= has switched it off")
        self.comes_back(c, pid)

    def test_6_the_process_stands_still(self):
        c, _ = self.playing()
        pid = main_pid()
        os.kill(pid, signal.SIGSTOP)
        self.off("SIGSTOP")
        wait_for(lambda: main_pid() not in (0, pid), "the watchdog starts it again", 60)
        self.assertTrue([text for _, text in said() if "Watchdog timeout" in text])
        self.comes_back(c, pid)

    def test_7_it_is_stopped_and_the_card_starts_it(self):
        c, number = self.playing()
        systemctl("stop", "tactor.service", "tactor.socket")
        self.assertEqual(c.await_end(number), "cancelled")
        self.assertFalse(c.hear("nothing more"))
        self.off("stop")
        self.assertEqual(shows("Result"), "success")
        Card.pull_out().wait(20)
        run("udevadm", "settle")  # nobody plugs in again before that is through
        wait_for(lambda: shows("ActiveState", CARD) == "inactive", "the card is gone for systemd, too")
        self.assertEqual(shows("ActiveState"), "inactive")
        Card.plug_in()
        wait_for(lambda: shows("ActiveState") == "active", "the card has started it", 60)
        self.playing()

    def test_8_it_is_hardened(self):
        run("systemd-analyze", "security", "--offline=true", "--threshold=20", UNITS / "system/tactor.service")
        run("systemd-analyze", "security", "--offline=true", "--threshold=30", UNITS / "user/tactor.service")

    def test_9_a_user_s_own_service(self):
        systemctl("stop", "tactor.service", "tactor.socket")
        run("useradd", "--groups", "audio,gpio", "--create-home", "maker")
        uid = run("id", "-u", "maker").strip()
        place = f"/run/user/{uid}"  # systemd unmounts its files from there
        run("systemd-run", "--unit=maker", "-p", "User=maker", "-p", "Delegate=yes", "-p", f"RuntimeDirectory=user/{uid}", "-p", "Type=notify",
            "-E", f"XDG_RUNTIME_DIR={place}", "/usr/lib/systemd/systemd", "--user", "--unit=sockets.target")

        def own(*args):
            return run("setpriv", "--reuid=maker", "--regid=maker", "--init-groups", "env", f"XDG_RUNTIME_DIR={place}",
                       "systemctl", "--user", *args).strip()

        own("start", "tactor.socket")
        c, _ = self.playing(f"{place}/tactor.sock")
        self.gpio.pull(LINE, True)
        self.addCleanup(self.gpio.pull, LINE, False)
        own("kill", "-s", "KILL", "tactor.service")
        self.off("SIGKILL of all", 60)
        self.assertFalse(c.hear("stroke", state="finished"))
        own("stop", "tactor.socket", "tactor.service")
