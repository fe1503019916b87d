# SPDX-License-Identifier: MIT
"""Live strokes on the fake DAC, whose clock moves when the test says so."""
import os
import subprocess
import sys
import textwrap

FEEDING = """
    import ctypes, gc, math, pathlib, sys
    import tactor

    # The caller keeps the interpreter's lock: playing would wait for ever if it ever asked for it.
    fake = ctypes.PyDLL(sys.argv[1])
    seconds = int(sys.argv[2])

    def resident():
        return int(pathlib.Path("/proc/self/statm").read_text().split()[1])

    with tactor.Player("fake", tactor.Array.preset("palm-3x3"), period_frames=480) as player:
        with player.live() as finger:
            finger.to(20, 20)
            fake.fake_await(960)
            for ms in range(1000 * seconds):
                if not finger.to(20 + 15 * math.sin(ms / 50), 20 + 15 * math.cos(ms / 70)):
                    sys.exit(finger.wait().reason)
                if ms % 10 == 9:  # a period
                    fake.fake_play(480)
                    fake.fake_await(960)
                if ms % 500 == 0:
                    junk = [[j] for j in range(1000)]
                    junk.append(junk)
                    gc.collect()
                if ms == 100 * seconds:
                    before = resident(), len(gc.get_objects())
            grown = resident() - before[0], len(gc.get_objects()) - before[1]
            finger.end()
            for _ in range(100):
                fake.fake_play(480)
                fake.fake_await(960)
        stats = player.stats()
        print(finger.report.state, finger.report.frames // 48000, finger.counts["points"], stats["xruns"], stats["stalls"], *grown)
"""


def test_ten_minutes_of_a_thousand_points_a_second_neither_fail_nor_grow(fake_pcm, tmp_path):
    seconds = 60 if os.environ.get("TACTOR_SOAK") == "short" else 600
    (tmp_path / "asound.conf").write_text(f'pcm_type.fake {{ lib "{fake_pcm}" }}\npcm.fake {{ type fake }}\n')
    env = {**os.environ, "TACTOR_CONFIG": os.devnull, "XDG_RUNTIME_DIR": str(tmp_path), "ALSA_CONFIG_PATH": str(tmp_path / "asound.conf")}
    for _ in range(5):
        r = subprocess.run([sys.executable, "-c", textwrap.dedent(FEEDING), fake_pcm, str(seconds)], env=env, capture_output=True,
                           text=True, timeout=1800, check=False)
        # A device whose clock stands still for half a second is lost. This process moves it, and the machine may be busy.
        if r.stderr != "the device stopped\n":
            break
    assert (r.returncode, r.stderr) == (0, "")
    state, *numbers = r.stdout.split()
    played, points, xruns, stalls, pages, objects = map(int, numbers)
    assert (state, played, points, xruns, stalls) == ("finished", seconds, 1000 * seconds + 1, 0, 0)
    # The address sanitizer keeps freed memory for a while.
    assert objects < 100 and (pages < 512 or "libasan" in os.environ.get("LD_PRELOAD", ""))  # 2 MB
