# SPDX-License-Identifier: MIT
"""The examples run."""
import ast
import contextlib
import json
import os
import pathlib
import re
import runpy
import signal
import socket
import socketserver
import subprocess
import sys
import textwrap
import threading
import time
import xml.etree.ElementTree

import pytest

import tactor

pytestmark = pytest.mark.unsanitized


def run(program, *arguments, cwd=None, **environment):
    env = {**os.environ, "TACTOR_CONFIG": os.devnull, "XDG_RUNTIME_DIR": "", **environment}
    r = subprocess.run([sys.executable, program, *map(str, arguments)], cwd=cwd, env=env, capture_output=True, text=True, timeout=120, check=False)
    assert (r.returncode, r.stderr) == (0, "")
    return r.stdout


def test_each_example_is_short_and_run_here(root):
    text = pathlib.Path(__file__).read_text(encoding="utf-8")
    examples = [p for p in (root / "examples/python").iterdir() if p.suffix in (".py", ".ipynb")]
    assert len(examples) >= 6
    for program in examples:
        assert f'"examples/python/{program.name}"' in text, program
        assert program.suffix != ".py" or program.read_text(encoding="utf-8").count("\n") <= 80, program


def test_a_staircase_of_twenty_lines_finds_the_threshold(root):
    program = root / "examples/python/staircase.py"
    said = run(program)
    assert abs(float(re.match(r"threshold: (-[\d.]+) dBFS", said)[1]) + 34) < 4
    code = program.read_text(encoding="utf-8").split('"""')[2].splitlines()
    assert sum(bool(line.strip()) for line in code) <= 20


def trials(text):
    head, *rows = (line.split("\t") for line in text.splitlines())
    return [dict(zip(head, row)) for row in rows]


def test_a_study_can_be_read(root, tmp_path):
    subprocess.run([sys.executable, root / "tests/study/studies.py", tmp_path], check=True)
    studies = sorted(p for p in tmp_path.iterdir() if (p / "participants.tsv").exists())
    assert studies
    for study in studies:
        lines = run(root / "examples/python/read_study.py", study).splitlines()
        assert lines and all(re.match(r"sub-\w+_task-[\w-]+_beh: \d+ trials: ", line) for line in lines)


def test_the_output_of_an_experiment_can_be_read(root, tool, tmp_path):
    for participant in ("01", "02"):
        tool("experiment", "park2016", "--participant", participant, "-o", "study", "--simulate", f"seed={participant},sigma=1")
    lines = run(root / "examples/python/read_study.py", tmp_path / "study").splitlines()
    assert {line[:6] for line in lines} == {"sub-01", "sub-02"}
    written = sum(row["void"] == "false" for file in (tmp_path / "study").glob("sub-*/beh/*_beh.tsv") for row in trials(file.read_text(encoding="utf-8")))
    assert sum(int(re.search(r": (\d+) trials: ", line)[1]) for line in lines) == written > 0


DRAWING = """
    import importlib.util, sys, tkinter
    import tactor
    spec = importlib.util.spec_from_file_location("draw", sys.argv[1])
    draw = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw)
    window = tkinter.Tk()
    with tactor.Player("null", tactor.Array.preset("palm-3x3")) as player:
        canvas = draw.Drawing(window, player)
        canvas.pack()
        window.update()
        canvas.event_generate("<Button-1>", x=100, y=100)
        for i in range(50):
            canvas.event_generate("<B1-Motion>", x=100 + 8 * i, y=100 + i)
            window.update()
        finger = canvas.finger
        canvas.event_generate("<ButtonRelease-1>", x=500, y=150)
        window.update()
        report = finger.wait(30)
        seen = len(canvas.find_withtag("way")), canvas.finger, report.state
        canvas.event_generate("<B1-Motion>", x=10, y=10)
        canvas.event_generate("<ButtonRelease-1>", x=10, y=10)
        window.update()
    window.destroy()
    print(*seen)  # the player's thread prints, too, and is over now
"""


@pytest.fixture
def display():
    """An invisible screen."""
    read, write = os.pipe()
    try:
        screen = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp"], pass_fds=[write],
                                  stderr=subprocess.DEVNULL)
    except FileNotFoundError:
        os.close(read)
        os.close(write)
        pytest.skip("Xvfb is not here: nothing is drawn with the mouse")
    os.close(write)
    with os.fdopen(read) as said:
        number = said.readline().strip()
    assert number, "Xvfb says no display"
    yield f":{number}"
    screen.terminate()
    screen.wait()


def test_strokes_drawn_with_the_mouse_are_played(root, tmp_path, display):
    pytest.importorskip("tkinter", reason="tkinter is not here: nothing is drawn with the mouse")
    (tmp_path / "drawing.py").write_text(textwrap.dedent(DRAWING))
    said = sorted(run(tmp_path / "drawing.py", root / "examples/python/draw.py", DISPLAY=display).splitlines())
    assert said[0] == "50 None finished"
    assert re.fullmatch(r"finished: (\d+) points, (\d+) outside", said[1]) and int(said[1].split()[1]) >= 51 and int(said[1].split()[3]) > 0


@contextlib.contextmanager
def service(tool, folder, *options):
    """Runs a service on a PCM that plays nothing; gives where it listens."""
    env = {**os.environ, "TACTOR_CONFIG": os.devnull, "XDG_RUNTIME_DIR": str(folder)}
    with subprocess.Popen([tool.program, "serve", "-D", "null", "--format", "json", *options], env=env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True) as p:
        try:
            yield json.loads(p.stdout.readline())
        finally:
            p.send_signal(signal.SIGTERM)


def test_a_client_draws_through_the_service(root, tool, tmp_path):
    with service(tool, tmp_path) as where:
        said = run(root / "examples/python/serve_client.py", where["socket"])
        assert run(root / "examples/python/serve_client.py", XDG_RUNTIME_DIR=str(tmp_path)) == said
    assert re.fullmatch(r"tactor/1 on palm-3x3, 48000 Hz\npark2016-1: finished after [1-9]\d+ frames\ncircle: finished\n", said)


def shown(cell, names):
    """Runs a cell as a notebook does; returns the value of its last line."""
    tree = ast.parse("".join(cell["source"]))
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, cell["id"], "exec"), names)
    return None if last is None else eval(compile(last, cell["id"], "eval"), names)


class Between(socketserver.StreamRequestHandler):
    """Stands between a client and a service, whose clock then is 3 ms ahead."""

    def handle(self):
        with socket.create_connection(self.server.behind) as behind, behind.makefile("r", encoding="utf-8") as lines:
            for line in self.rfile:
                behind.sendall(line)
                answer = json.loads(lines.readline())
                answer["result"]["clock"]["unix_s"] += 0.003
                self.wfile.write(json.dumps(answer).encode() + b"\n")


def test_two_machines_draw_one_array(root, tool, tmp_path, monkeypatch):
    program, array = root / "examples/python/two_machines.py", root / "examples/rtp/both.toml"
    monkeypatch.setenv("PATH", f"{pathlib.Path(tool.program).parent}:{os.environ['PATH']}")

    def refuse(*arguments):
        r = subprocess.run([sys.executable, program, *map(str, arguments)], capture_output=True, text=True, cwd=tmp_path, timeout=120, check=False)
        assert r.returncode == 1
        return r.stderr

    def strokes(i):
        r = subprocess.run([tool.program, "status", "--socket", tmp_path / str(i), "--format", "json"], capture_output=True, text=True, timeout=60, check=True)
        return json.loads(r.stdout)["strokes"]

    run(program, "split", array, "left=0-11", "right=12-23", cwd=tmp_path)
    for place, first in (("left", 0), ("right", 12)):
        bindings = re.findall(r"^bindings\.(\d+) { slave (\w+) channel (\d+) }$", (tmp_path / f"{place}.asoundrc").read_text(encoding="utf-8"), re.M)
        assert [(int(c), int(at)) for c, slave, at in bindings if slave == "card"] == [(first + i, i) for i in range(12)]
        assert sorted(int(c) for c, _, _ in bindings) == list(range(24))
    assert "channel 11 is on no machine, or on both" in refuse("split", array, "left=0-11", "right=11-23")
    assert "ValueError" in refuse("split", array, "left", "right=12-23")

    # Presets, arrays without channels, and names with hyphens.
    (tmp_path / "own.toml").write_text('[array]\npreset = "palm-3x3"\n[[tactor]]\ntactor = 4\nchannel = 9\n', encoding="utf-8")
    (tmp_path / "other.toml").write_text('[array]\nfile = "own.toml"\n', encoding="utf-8")
    shipped = root / "examples/arrays"
    for its_array, last in (("palm-3x3", 8), ("palm-2x4", 7), (tmp_path / "own.toml", 9), (tmp_path / "other.toml", 9), (shipped / "arm-line-4.toml", 3),
                            (shipped / "honeycomb.toml", 7), (shipped / "lra-row-3.toml", 2), (shipped / "ring-8.toml", 7), (shipped / "scattered-12.toml", 11)):
        run(program, "split", its_array, "left-arm=0-1", f"right-arm=2-{last}", cwd=tmp_path)
        for side, mine in (("left-arm", range(2)), ("right-arm", range(2, last + 1))):
            bindings = re.findall(r"^bindings\.(\d+) { slave (\w+) channel (\d+) }$", (tmp_path / f"{side}.asoundrc").read_text(encoding="utf-8"), re.M)
            assert [(int(c), int(at)) for c, slave, at in bindings if slave == "card"] == [(c, at) for at, c in enumerate(mine)], its_array
            assert sorted(int(c) for c, _, _ in bindings) == list(range(last + 1))

    with contextlib.ExitStack() as services:
        places = []
        (tmp_path / "differ.toml").write_text('[defaults]\nlevel_dbfs = -40.0\nalgorithm = "tactile-brush"\n', encoding="utf-8")
        for i, options in enumerate((("--array", array), ("--array", array), ("--array", "palm-3x3"), ("--array", array, "--config", tmp_path / "differ.toml"))):
            where = services.enter_context(service(tool, tmp_path, "--socket", f"{tmp_path}/{i}", *options, "--tcp", "0"))
            places.append(where["tcp"])
        left, right, other, differs = places
        said = run(program, "draw", left, right, "M 0 0 H 100").splitlines()
        assert re.fullmatch(rf"{right}'s clock is [+-]0\.\d{{3}} ms from {left}'s, known to \d\.\d{{3}} ms", said[0])
        assert [re.sub(r"\d+\.\d+ ms", "0 ms", s) for s in said[1:]] == [f"{m}: finished, 0 ms late" for m in (left, right)]
        with subprocess.Popen([sys.executable, program, "draw", left, right, "M 0 0 H 100" + " H 0 H 100" * 19], stdout=subprocess.PIPE, text=True) as client:
            client.stdout.readline()
            while not all(strokes(i) for i in (0, 1)):
                assert client.poll() is None
            subprocess.run([tool.program, "stop", "--socket", tmp_path / "0"], check=True)
            assert "cancelled stopped by another client" in client.communicate(timeout=60)[0] and client.returncode == 1
        end = time.monotonic() + 20
        while strokes(1):  # it fades, though nobody stopped it there
            assert time.monotonic() < end
        assert "different arrays" in refuse("draw", left, other, "M 0 0 H 100")
        assert "the machines plan different strokes (give both" in refuse("draw", left, differs, "M 0 0 H 100")
        with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Between) as between:
            between.behind = right.rsplit(":", 1)
            threading.Thread(target=between.serve_forever, daemon=True).start()
            assert "the clocks must agree within 2 ms" in refuse("draw", left, f"127.0.0.1:{between.server_address[1]}", "M 0 0 H 100")
            between.shutdown()


def test_a_notebook_goes_from_stroke_to_figure(root, tool, tmp_path, monkeypatch):
    notebook = json.loads((root / "examples/python/from_stroke_to_figure.ipynb").read_text(encoding="utf-8"))
    try:
        import nbformat
        nbformat.validate(notebook)
    except ImportError:
        pytest.skip("nbformat is not here: the notebook is not checked")
    pytest.importorskip("pandas", reason="pandas is not here: the notebook does not run")
    monkeypatch.chdir(tmp_path)
    names = {}
    results = {c["id"]: shown(c, names) for c in notebook["cells"] if c["cell_type"] == "code"}
    assert all(c["outputs"] == [] and c["execution_count"] is None for c in notebook["cells"] if c["cell_type"] == "code")
    for name in ("stroke", "plan", "compare"):
        assert xml.etree.ElementTree.fromstring(results[name]._repr_svg_()).tag.endswith("svg")
    assert isinstance(results["plan"], tactor.Plan) and len(results["table"]) == 18
    assert set(results["errors"]) == {"park2016", "tactile-brush", "continuous"} and results["score"][0][1] == 9
    tool("render", "--path", "M 0 10 C 20 -5 20 45 40 30", "--duration", "1.2", "--phantom", "barycentric", "-o", "tool.wav")
    assert (tmp_path / "curve.wav").read_bytes() == (tmp_path / "tool.wav").read_bytes()
    assert (tmp_path / "curve.pdf").read_bytes().startswith(b"%PDF")


def test_a_study_becomes_a_figure(root, tool, tmp_path, monkeypatch, capsys):
    pytest.importorskip("pandas", reason="pandas is not here: no figure of a study is drawn")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    pytest.importorskip("matplotlib", reason="Matplotlib is not here: no figure of a study is drawn")
    monkeypatch.chdir(tmp_path)
    for participant in ("01", "02", "03"):
        tool("experiment", "park2016", "--participant", participant, "-o", "strokes", "--simulate", f"seed={participant},sigma=1")
    guide = (root / "man/guide/python.md").read_text(encoding="utf-8")
    exec(textwrap.dedent(re.search(r"## Read a study\n\n((?:    .*\n|\n)+)", guide)[1]), {})
    assert (tmp_path / "ratings.pdf").read_bytes().startswith(b"%PDF")
    monkeypatch.setattr(sys, "argv", ["study_figure.py", "strokes", "uniformity-rating", "means.png"])
    capsys.readouterr()
    names = runpy.run_path(str(root / "examples/python/study_figure.py"))
    assert (tmp_path / "means.png").read_bytes().startswith(b"\x89PNG")
    means = tactor.study.analyze("strokes")["runs"]["uniformity-rating"]["means"]
    for method, cells in names["people"].mean().items():
        assert dict(cells) == pytest.approx({motion: cell["mean"] for motion, cell in means[method]["motion"].items()})
    assert re.fullmatch(r"difference -?[\d.]+, t\(2\) = -?[\d.]+, p = [\d.e-]+\n", capsys.readouterr().out)


def test_the_guide_draws_live(root, tmp_path):
    guide = (root / "man/guide/python.md").read_text(encoding="utf-8")
    code = textwrap.dedent(re.search(r"## Draw live, point by point\n\n((?:    .*\n|\n)+)", guide)[1])
    # It does not end by itself, however slowly this machine sends points.
    (tmp_path / "live.py").write_text(code.replace("level_dbfs=-40", "level_dbfs=-40, timeout=86400"))
    report = run(tmp_path / "live.py")
    assert "state='finished'" in report and "points=100," in report and "outside_points=0" in report


def test_the_readme_runs(root, tmp_path):
    text = (root / "README.md").read_text(encoding="utf-8")
    block = re.search(r"## From Python\n\n((?:    .*\n|\n)+)", text)[1]
    code = "\n".join(line[4:] for line in block.splitlines()).replace("hw:CARD=Tactor", "null")
    (tmp_path / "readme.py").write_text(code)
    assert "state='finished'" in run(tmp_path / "readme.py")
