#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws on one array that two machines share, each with `tactor serve`. Needs the tool `tactor`, neither NumPy nor this package.
    two_machines.py split ARRAY NAME=FIRST-LAST NAME=FIRST-LAST   writes NAME.asoundrc: a PCM that plays these channels of the array
    two_machines.py draw HOST:PORT HOST:PORT PATH [TOKEN_FILE]    draws a path, if both plan the same and their clocks agree within 2 ms"""
import contextlib
import json
import pathlib
import socket
import subprocess
import sys
import time


def split(file, *machines):
    command = [*"tactor plan --outside clamp --algorithm continuous --duration 1 --format json --path".split(), "M 0 0", "--array", file]
    channels = sorted(t["channel"] for t in json.loads(subprocess.check_output(command))["array"]["tactors"])
    own = {name: range(*(int(end) + i for i, end in enumerate(share.split("-")))) for name, share in (m.rsplit("=", 1) for m in machines)}
    if unclear := [c for c in channels if sum(c in mine for mine in own.values()) != 1]:
        sys.exit(f"{file}: channel {unclear[0]} is on no machine, or on both (give each channel to one)")
    for name, mine in own.items():
        others = [c for c in range(channels[-1] + 1) if c not in mine]
        pathlib.Path(f"{name}.asoundrc").write_text("\n".join((
            f"# The card's first outputs play channels {mine[0]} to {mine[-1]} of {file}; the others are dropped.", "pcm.tactor-half {", "type multi",
            f'slaves.card {{ pcm "hw:CARD=Tactor" channels {len(mine)} }}', f'slaves.none {{ pcm "null" channels {len(others) or 1} }}',
            *(f"bindings.{c} {{ slave {slave} channel {at} }}" for slave, on in (("card", mine), ("none", others)) for at, c in enumerate(on)),
            "}\n")), encoding="utf-8")


class Machine:  # JSON-RPC over TCP, an object a line: tactor-protocol(7)
    def __init__(self, place, token):
        self.place, self.calls, self.told, asked = place, 0, [], []
        self.socket = socket.create_connection(place.rsplit(":", 1), timeout=10)
        self.lines = self.socket.makefile(encoding="utf-8")
        for _ in range(40):
            before = time.monotonic()
            self.hello = self.call("hello", **token)
            asked.append((time.monotonic() - before, self.hello["clock"]["unix_s"] - (before + time.monotonic()) / 2))
        self.trip_s, self.lead_s = min(asked)  # the fastest answer tells the clock best

    def call(self, method, **params):
        self.calls += 1
        self.socket.sendall(json.dumps({"jsonrpc": "2.0", "id": self.calls, "method": method, "params": params}).encode() + b"\n")
        reply = self.wait(lambda m: m.get("id") == self.calls)
        return reply["result"] if "result" in reply else sys.exit("{what}: {why} ({hint})".format(**reply["error"]["data"]))

    def wait(self, wanted):
        while not (found := [m for m in self.told if wanted(m)]):
            self.told.append(json.loads(self.lines.readline() or sys.exit(f"{self.place}: the service has gone")))
        return found[0]


def draw(first, second, path, token_file=None, limit_s=0.002, after_s=0.5):
    token = {"token": pathlib.Path(token_file).read_text(encoding="utf-8").strip()} if token_file else {}
    machines, strokes = [Machine(first, token), Machine(second, token)], {}
    machines[0].hello["array"] == machines[1].hello["array"] or sys.exit("the machines have different arrays (start both with the same --array)")
    apart_s, known_s = machines[1].lead_s - machines[0].lead_s, sum(m.trip_s for m in machines) / 2
    print(f"{second}'s clock is {1000 * apart_s:+.3f} ms from {first}'s, known to {1000 * known_s:.3f} ms")
    max(abs(apart_s), known_s) > limit_s and sys.exit(f"the clocks must agree within {1000 * limit_s:g} ms (synchronise them, over a wire)")
    plans = [m.call("plan", path=path) for m in machines]
    plans[0] == plans[1] or sys.exit("the machines plan different strokes (give both the same version, array and [defaults])")
    start_s = machines[0].lead_s + time.monotonic() + after_s
    with contextlib.ExitStack() as at_end:
        for m in machines:
            strokes[m] = m.call("play", path=path, start={"unix_s": start_s})
            # Without this client the strokes would play on. One that has ended takes no notice.
            at_end.callback(m.socket.sendall, b'{"jsonrpc":"2.0","method":"cancel","params":{"stroke":%d}}\n' % strokes[m]["stroke"])
        for m, played in strokes.items():
            m.socket.settimeout(after_s + played["total_s"] + 5)
            end = m.wait(lambda n, s=played["stroke"]: (p := n.get("params", {})).get("stroke") == s and p["state"] != "started")["params"]
            print(f"{m.place}: {end['state']} {end['reason']}".rstrip() + f", {1000 * end['late_s']:.3f} ms late")
            end["state"] == "finished" or sys.exit(1)
    return start_s


if __name__ == "__main__":
    try:
        {"split": split, "draw": draw}.get(sys.argv[1] if len(sys.argv) > 4 else "", lambda *_: sys.exit(__doc__))(*sys.argv[2:])
    except (OSError, KeyError, ValueError, subprocess.SubprocessError) as e:
        sys.exit(f"{' '.join(sys.argv[1:])}: {type(e).__name__}: {e}")
