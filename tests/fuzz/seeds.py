# SPDX-License-Identifier: MIT
"""Writes what the fuzzers start from: the examples, the texts in the readers' own tests, and messages to the service.

Usage: seeds.py SOURCE_ROOT FOLDER. Makes FOLDER/TARGET/... for each fuzzer of a reader.
"""
import hashlib
import json
import pathlib
import re
import struct
import sys

# Target: files that are seeds whole; tests whose string literals are.
SOURCES = {
    "config_toml": (["examples/tactor.toml", "examples/arrays/*.toml"], ["files/test_setup.cpp", "files/test_setup_array.cpp"]),
    "stroke_toml": (["examples/strokes/*.toml"], ["files/test_stroke_csv.cpp", "files/test_stroke_load.cpp", "files/test_stroke_order.cpp"]),
    "stroke_csv": (["examples/strokes/*.csv"], ["files/test_stroke_csv.cpp"]),
    "stroke_svg": (["examples/strokes/*.svg"], ["files/test_stroke_svg.cpp", "files/test_stroke_svg_style.cpp"]),
    "stroke_tact": (["examples/strokes/*.tact"], ["files/test_stroke_tact.cpp"]),
    "stroke_haptic": (["examples/strokes/*.haptic"], ["files/test_vibration.cpp"]),
    "stroke_ahap": (["examples/strokes/*.ahap"], ["files/test_vibration.cpp"]),
    "path_data": ([], ["core/test_path_svg.cpp", "core/test_path.cpp"]),
    "study_table": ([], ["study/test_study_files.cpp"]),
    "pcm_name": ([], ["sink/alsa/test_devices.cpp"]),
}

def wav_files():
    """A few samples in each format, plain and behind other chunks; the greatest and least floats; and what recorders leave unsaid."""
    for tag, bits in ((1, 8), (1, 16), (1, 24), (1, 32), (3, 32), (3, 64), (0xFFFE, 16)):
        size = bits // 8
        form = struct.pack("<HHIIHH", tag, 1, 8000, 8000 * size, size, bits) + (struct.pack("<HHIHH", 22, bits, 4, 1, 0) if tag == 0xFFFE else b"")
        one = {32: struct.pack("<f", 0.5), 64: struct.pack("<d", 0.5)}[bits] if tag == 3 else bytes(size - 1) + b"\x40"
        extreme = [struct.pack("<4f", *v) for v in ((3.4e38, -3.4e38, -3.4e38, 3.4e38), (1e-45, 0.0, -1e-45, 0.0))] if (tag, bits) == (3, 32) else []
        for data in [one * 16 + bytes(size) * 16, *extreme]:
            for before in (b"", b"LIST" + struct.pack("<I", 4) + b"INFO"):
                chunks = before + b"fmt " + struct.pack("<I", len(form)) + form + b"data" + struct.pack("<I", len(data)) + data
                yield b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks
    in_four_bytes = struct.pack("<HHIIHH", 1, 1, 8000, 32000, 4, 24)
    for kind, size, before in ((b"RF64", 0xFFFFFFFF, b"ds64" + struct.pack("<IQQQI", 28, 0, 64, 16, 0)), (b"BW64", 0, b""), (b"RIFF", 0x7FFFF000, b""),
                               (b"RIFF", 64, b"note" + struct.pack("<I", 3) + b"odd")):
        yield kind + b"\xff\xff\xff\xffWAVE" + before + b"fmt " + struct.pack("<I", 16) + in_four_bytes + b"data" + struct.pack("<I", size) + bytes(range(64))


def plan_seeds():
    """Plans of two tactors: bursts and samples, with other carriers and waveforms, alone and in a list."""
    def drives(*amplitudes):
        return [{"tactor": i, "channel": i, "amplitude": a} for i, a in enumerate(amplitudes)]
    head = {"schema": "tactor-plan/1", "algorithm": "park2016", "phantom": "inverse-distance", "start_s": 0.0, "start_frame": 0, "follows": True,
            "stroke": {"name": "x", "duration_s": 0.1, "length_mm": 20.0, "carrier_hz": 250.0},
            "array": {"name": "a", "tactors": [{"tactor": i, "x_mm": 20.0 * i, "y_mm": 0.0, "channel": i, "polarity": 1, "gain_db": 0.0, "max_dbfs": -6.0, "threshold_dbfs": None} for i in range(2)]},
            "soa_s": 0.07, "total_s": 0.14, "conflicts": [], "dropped": [], "warnings": [],
            "render": {"rate": 48000, "channels": 2, "frames": 6720, "phase": "stroke", "ramp_s": None, "level_dbfs": -12.0,
                       "overlap": "energy", "peak_dbfs": [-12.0, -12.0], "marker": None}}
    bursts = {"bursts": [{"onset_s": t, "duration_s": 0.07, "ramp_s": 0.0, "x_mm": x, "y_mm": 0.0, "intensity": 1.0, "drives": drives(*a)}
                         for t, x, a in ((0.0, 0.0, (1.0,)), (0.07, 14.0, (0.5477225575051661, 0.8366600265340756)))]}
    points = [{"t_s": 0.001 * k, "x_mm": 5.0 * k, "y_mm": 0.0, "intensity": 1.0, "drives": drives((1 - k / 4) ** 0.5, (k / 4) ** 0.5)} for k in range(5)]
    samples = {"algorithm": "continuous", "soa_s": None, "total_s": 0.004, "bursts": [], "continuous": {"step_s": 0.001, "ramp_s": 0.0, "points": points}}
    course = [{"t_s": 0.0, "hz": 100.0, "bend": [10.0, 0.0, 0.0, 0.0]}, {"t_s": 0.1, "hz": 200.0}]
    sounds = [{}, {"waveform": "square"}, {"waveform": "triangle"}, {"waveform": "noise:100-300", "noise_seed": 7}, {"course": course},
              {"course": course, "waveform": "sawtooth"}]
    plans = [head | body | {"stroke": head["stroke"] | sound | ({"duration_s": 0.004} if "continuous" in body else {})} for body in (bursts, samples) for sound in sounds]
    return [json.dumps(p).encode() for p in [*plans, head | bursts | {"render": head["render"] | {"phase": "burst", "ramp_s": 0.005, "marker": None}}]]


# Inputs that tests make of parts: each line is a seed.
def rpc_seeds():
    stroke = '{"path":"M 0 0 L 40 40","options":{"algorithm":"continuous","duration":0.01}'
    calls = ['"hello","params":{"name":"Ann"}', '"status"', '"options"', '"stop"', '"fire"', f'"play","params":{stroke}}}', f'"play","params":{stroke},"start":"armed"}}',
             f'"play","params":{stroke},"start":{{"delay_s":0.01}}}}', f'"plan","params":{stroke}}}',
             f'"plan","params":{stroke},"view":"percept","observer":"centroid","draft":1}}', f'"plan","params":{stroke},"view":"bursts","draft":2}}',
             f'"plan","params":{stroke},"view":"peaks","bins":9}}',
             '"play","params":{"stroke":"park2016-1","options":{"soa":0.07,"snap":true}}',
             '"play","params":{"points":[[0,0,0],[0.1,20,20,0.5]]}', '"play","params":{"csv":"t_s,x_mm,y_mm\\n0,0,0\\n1,10,10\\n"}',
             '"play","params":{"svg":"<svg><path d=\\"M 0 0 L 9 9\\"/></svg>"}',
             '"play","params":{"toml":"[[stroke]]\\npath = \\"M 0 0 L 9 9\\"\\n"}', '"begin","params":{"timeout_s":0.01}',
             '"to","params":{"stroke":1,"x_mm":20,"y_mm":20,"intensity":0.5}', '"end","params":{"stroke":1}', '"cancel","params":{"stroke":1}', '"level","params":{"db":-6.5,"stroke":1}',
             '"drive","params":{"tactor":4,"intensity":0.5,"duration_s":0.01,"start":"now"}',
             '"subscribe","params":{"events":["strokes","levels","stream","touches","stops"],"levels_hz":100}']
    lines = [f'{{"jsonrpc":"2.0","id":{i},"method":{call}}}' for i, call in enumerate(calls)]
    # An empty line lets time pass: strokes that begin, go on and end, in some orders.
    named = {re.match(r'"(\w+)"', call)[1]: line for call, line in zip(calls, lines)}
    armed = next(line for line in lines if '"armed"' in line)
    orders = [[named["begin"], named["to"], "", named["to"], "", named["end"]], [named["begin"], named["to"], "", named["cancel"]],
              [armed, "", named["fire"], "", named["stop"]], [named["play"], "", named["drive"], "", named["cancel"], named["status"]]]
    touch = '{"Type":"%s","Key":"a","Parameters":{"scaleOption":{"intensity":0.5,"duration":2},"rotationOption":{"offsetAngleX":"90","offsetY":0.1}}}'
    frame = '{"Type":"frame","Key":"b","Frame":{"DurationMillis":20,"Position":"VestFront","PathPoints":[{"X":"0.5","Y":0.25,"Intensity":100,"MotorCount":3}],"DotPoints":[{"Index":4,"Intensity":50}]}}'
    dots = '{"startTime":0,"endTime":20,"playbackType":"NONE","pointList":[{"index":0,"intensity":1}]}'
    project = '{"Key":"a","Project":{"tracks":[{"enable":true,"effects":[{"startTime":0,"offsetTime":20,"modes":{"VestFront":{"mode":"DOT_MODE","dotMode":{"feedback":[%s]}}}}]}],"layout":{"layouts":{"VestFront":[{"index":0,"x":"0.5","y":"0.5"}]}}}}' % dots
    programs = ['!{"Register":[%s]}' % project, '!{"Submit":[%s,%s]}' % (touch % "key", frame), "", '!{"Submit":[%s]}' % (touch % "turnOff"), '!{"submit":[{"type":"turnOffAll"}]}']
    orders.append(programs)
    whole = [f"[{','.join(lines)}]", *("\n".join(order) for order in [lines, *orders])]
    return [text.encode() for text in lines + whole]


def actuator_seeds():
    """Actuator files with one number or shape changed, in JSON5's ways of writing it."""
    file = "{ continuous: { gain: %s, emphasis_ducking: 0.5, frequency_min: 55, frequency_max: 200 }, emphasis: { gain: 1.0, fade_out_percent: %s, " \
           "frequency_min: { output_frequency: %s, duration_ms: 27, shape: '%s' }, frequency_max: { 'output_frequency': 130, \"duration_ms\": 20, shape: \"square\", }, }, }"
    usual = ("1", "0", "55", "sine")
    changes = [(i, v) for i, values in enumerate(((".5", "+1.", "-1", "0x1"), ("50", "100"), ("1e400", "NaN"), ("saw", "it\\'s", "triangle"))) for v in values]
    return [(file % tuple(change if k == i else v for k, v in enumerate(usual))).encode() for i, change in changes]


def osc_seeds():
    def text(s):
        return s.encode() + bytes(4 - len(s) % 4)

    def message(address, *values):
        tags = "".join({int: "i", float: "f", str: "s"}[type(v)] for v in values)
        return text(address) + text("," + tags) + b"".join(text(v) if isinstance(v, str) else struct.pack(">" + tags[i], v)
                                                           for i, v in enumerate(values))

    def bundle(tag, *elements):
        return b"#bundle\0" + struct.pack(">Q", tag) + b"".join(struct.pack(">i", len(e)) + e for e in elements)

    each = [message("/tactor/play", 1, "M 0 0 L 40 40", "soa=0.07"), message("/tactor/play", "park2016-1"), message("/tactor/begin", 1, "timeout_s=1"),
            message("/tactor/to", 1, 20.0, 20.0, 0.5), message("/tactor/end", 1), message("/tactor/cancel", 1), message("/tactor/stop"),
            message("/tactor/drive", 4, 0.5, 0.1), message("/tactor/subscribe", 9000, "levels", "stream"), message("/tactor/error", "/x", "why"),
            text("/x") + text(",ihfdsSbTFNItcrm") + bytes(64), text("/tactor/stop")]
    return each + [bundle(1, *each), bundle(0xEA00000080000000, bundle(1, each[0]), each[6])]


def web_seeds():
    head = b"GET / HTTP/1.1\r\nHost: h\r\n"
    rpc = b"GET /rpc HTTP/1.1\r\nHost: h\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" \
          b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    requests = [head + b"\r\n", head + b"Origin: http://h\r\nAuthorization: Bearer x\r\n\r\n", head.replace(b"GET", b"POST") + b"Content-Length: 5\r\n\r\nabcde",
                head + b"Transfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n", rpc, rpc + b"\x81\x82\0\0\0\0[]"]
    frames = [b"\x81\x82\0\0\0\0[]", b"\x81\x85\0\0\0\0close", b"\x01\x81\0\0\0\0a\x80\x81\1\2\3\4b", b"\x82\x81\0\0\0\0x", b"\x89\x81\0\0\0\0p",
              b"\x88\x82\0\0\0\0\x03\xe8", b"\x81\xfe\x01\x00\0\0\0\0" + bytes(256), b"\x81\x82\0\0\0\0\xc3\x28", b"\x81\x02[]"]
    names = [b"127.0.0.1:4003\nhttp://127.0.0.1:4003", b"localhost:4003\nhttps://localhost:4003", b"[::1]:80\nnull"]
    return [b"\0" + r for r in requests] + [b"\1" + f for f in frames] + [b"\1" + b"".join(frames[:5])] + [b"\2" + n for n in names]


MADE = {"actuator": actuator_seeds, "plan_json": plan_seeds, "wav_file": wav_files, "rpc_message": rpc_seeds, "osc_packet": osc_seeds, "web_request": web_seeds}
RAW = r'R"(\w*)\((.*?)\)\1"'
PLAIN = r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*'
LITERAL = re.compile(f"{RAW}|({PLAIN})", re.S)


def literal_bytes(literal):
    """Returns what a compiler makes of a plain literal's inside."""
    as_characters = re.sub(r"(?<!\\)((?:\\\\)*)\\u([0-9a-fA-F]{4})", lambda m: m[1] + chr(int(m[2], 16)), literal)
    return as_characters.encode().decode("unicode_escape").encode("latin-1")


def literals(text):
    code = re.sub(r"^\s*#\s*include.*$|TEST_CASE\([^\n]*", "", text, flags=re.M)
    for match in LITERAL.finditer(code):
        if match[3]:
            yield literal_bytes("".join(re.findall(r'"((?:[^"\\]|\\.)*)"', match[3])))
        else:
            yield match[2].encode()


def seeds(root, target):
    if target in MADE:
        yield from MADE[target]()
        return
    whole, tests = SOURCES[target]
    for pattern in whole:
        yield from (f.read_bytes() for f in sorted(root.glob(pattern)))
    for name in tests:
        yield from (s for s in literals((root / "tests" / name).read_text(encoding="utf-8")) if len(s) > 3)


def main():
    root, folder = (pathlib.Path(a) for a in sys.argv[1:])
    for target in SOURCES | MADE:
        place = folder / target
        place.mkdir(parents=True, exist_ok=True)
        count = 0
        for count, seed in enumerate(seeds(root, target), 1):
            (place / hashlib.sha1(seed).hexdigest()).write_bytes(seed)
        if count < 10:
            sys.exit(f"seeds.py: only {count} seeds for {target}: have the tests moved?")


if __name__ == "__main__":
    main()
