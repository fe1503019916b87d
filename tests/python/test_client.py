# SPDX-License-Identifier: MIT
"""The service, as programs in Python draw through it."""
import asyncio
import contextlib
import errno
import gc
import inspect
import json
import os
import re
import socket
import subprocess
import threading
import time

import pytest

import tactor
from conftest import refused

LONG = 120.0  # s: a longer answer never comes


@contextlib.contextmanager
def serving(folder, limit="max_level_dbfs = -6.0"):
    """A service on ALSA's null device: its address, and its process."""
    path, config = folder / "tactor.sock", folder / "c.toml"
    config.write_text(f"[serve]\n{limit}\n")
    with subprocess.Popen([os.environ["TACTOR_TOOL"], "serve", "--socket", path, "-D", "null", "--config", config], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL) as server:
        assert server.stdout.readline()  # says where it listens
        try:
            yield path, server
        finally:
            server.terminate()


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    """Address of a service."""
    with serving(tmp_path_factory.mktemp("service")) as (path, _):
        yield path


@pytest.fixture
def client(service):
    with tactor.Client(service) as c:
        yield c


@pytest.fixture
def tap():
    return tactor.Stroke.along(tactor.Path.svg("M 5 5 L 35 30"), duration=0.1)


@pytest.fixture
def endless():
    return tactor.Stroke.along(tactor.Path.svg("M 5 5 L 35 30"), duration=300)


def test_strokes_are_played_and_waited_for(client, tap):
    assert client.hello["protocol"].startswith("tactor/") and client.hello["array"]["name"] == "palm-3x3"
    before = time.monotonic()
    stroke = client.play(tap, algorithm="continuous", level_dbfs=-30)
    report = stroke.wait(LONG)
    assert (report.state, report.reason) == ("finished", "") and report.frames == 4800 and before < report.started_s < time.monotonic()
    assert stroke.done() and stroke.report == report and stroke.id > 0
    for drawn in (tactor.Path.svg("M 5 5 L 9 9"), "park2016-1"):
        assert client.play(drawn, duration=0.05, algorithm="continuous").wait(LONG).state == "finished"
    assert tactor.Client(client._wire.path).play(tap, algorithm="continuous").wait(LONG).state == "finished"
    late = client.play(tap, delay=0.2).wait(LONG)
    assert late.started_s > report.started_s + 0.2 and late.late_s < LONG


def test_a_client_of_another_computer_comes_by_tcp_with_the_token(tmp_path, tap):
    token, config = tmp_path / "token", tmp_path / "c.toml"
    token.write_text("a token of many letters\n")
    token.chmod(0o600)
    config.write_text(f'[serve]\ntoken_file = "{token}"\n')
    with subprocess.Popen([os.environ["TACTOR_TOOL"], "serve", "--socket", tmp_path / "s.sock", "--tcp", "0", "-D", "null", "--config", config,
                           "--format", "json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as server:
        try:
            where = json.loads(server.stdout.readline())["tcp"]
            with tactor.Client(tcp=where, token="a token of many letters") as c:
                assert c.play(tap, algorithm="continuous", level_dbfs=-30).wait(LONG).state == "finished"
                assert where in repr(c)
            for token_given in (None, "another"):
                assert "token" in refused(lambda: tactor.Client(tcp=where, token=token_given), tactor.StreamError).what
        finally:
            server.terminate()
    refused(lambda: tactor.Client(tcp=where), tactor.DeviceError)
    for wrong in ("pi.lan", "::1:4001", "4001x", "127.0.0.1:0", "127.0.0.1:70000", "a..b:1", "x" * 300 + ":1", "1" * 5000):
        e = refused(lambda: tactor.Client(tcp=wrong))
        assert "not an address" in e.why and e.field == "tcp"
    refused(lambda: tactor.Client(tmp_path / "s.sock", tcp="127.0.0.1:4001"))


def test_strokes_are_awaited(service, tap, endless):
    async def draw():
        async with tactor.Client(service) as c:
            first, second = await asyncio.gather(c.play(tap), c.play(tap))
            assert first.state == second.state == "finished"
            forsaken = asyncio.ensure_future(c.play(endless, algorithm="continuous"))
            await asyncio.sleep(0.2)
            forsaken.cancel()
            with pytest.raises(asyncio.CancelledError):
                await forsaken
            with pytest.raises(tactor.InputError):
                await c.play("park")
            while (await c.status())["strokes"]:
                await asyncio.sleep(0.02)
            async with c.live(level_dbfs=-30) as finger:
                finger.to(10, 10)
                await asyncio.sleep(0.05)
            return finger.report.state
    assert asyncio.run(draw()) == "finished"


def test_refusals_of_the_service_are_raised(client, tap):
    for call, what in ((lambda: client.play("park"), "stroke"), (lambda: client.play(tap, soa=5), "options.soa"), (lambda: client.play(tap, level_dbfs=0), "level"),
                       (lambda: client.call("dance"), "method"), (lambda: client.plan(tap, tempo=3), "options.tempo")):
        e = refused(lambda: call().wait(LONG))
        assert what in e.what and e.why
    refused(lambda: client.live(algorithm="tango"), tactor.Error)
    with pytest.raises(TypeError, match="stroke: "):
        client.play(3)
    for wrong in (dict(at_s=1.0, delay=2.0), dict(start="armed", delay=1.0), dict(phantom=type("own", (), {"weights": None})())):
        refused(lambda: client.play(tap, **wrong))


def test_plans_are_those_of_this_package(client, tap, palm):
    plan = client.plan(tap, level_dbfs=-20).wait(LONG)
    assert isinstance(plan, tactor.Plan) and plan.bursts == tactor.plan(palm, tap).bursts


def test_strokes_are_cancelled_stopped_and_fired(client, endless, tap):
    stroke = client.play(endless, algorithm="continuous")
    stroke.cancel()  # before its number is known, too
    assert stroke.wait(LONG).state == "cancelled"
    stroke = client.play(endless, algorithm="continuous")
    client.stop().wait(LONG)
    assert stroke.wait(LONG).state == "cancelled"
    armed = client.play(tap, start="armed")
    while not any(s["state"] == "armed" for s in client.status().wait(LONG)["strokes"]):
        time.sleep(0.01)
    with pytest.raises(TimeoutError):
        armed.wait(0.05)
    assert client.fire().wait(LONG) == 1 and armed.wait(LONG).state == "finished"
    assert client.drive(4, 0.1, 0.05).wait(LONG).state == "finished"


def test_live_strokes_follow_and_end_with_their_block(client):
    with client.live(smooth=0.01, phantom="barycentric", level_dbfs=-30) as finger:
        for i in range(20):
            finger.to(10 + i, 20, 0.5)
            time.sleep(0.002)
    assert finger.report.state == "finished" and finger.report.frames > 0
    with pytest.raises(ValueError, match="out"):
        with client.live() as finger:
            finger.to(10, 10)
            raise ValueError("out")
    assert finger.wait(LONG).state == "cancelled"
    assert client.live(timeout=0.05).wait(LONG).state == "interrupted"
    refused(lambda: finger.to(float("nan"), 0))


def test_callbacks_run_in_the_clients_thread(client, tap):
    told = []
    stroke = client.play(tap)
    stroke.add_done_callback(lambda s: told.append((threading.current_thread().name, s.report.state)))
    stroke.wait(LONG)
    while not told:
        time.sleep(0.01)
    assert told == [("tactor-client", "finished")]
    stroke.add_done_callback(lambda s: told.append(s))
    assert told[-1] is stroke


def test_a_missing_service_is_an_error(tmp_path, monkeypatch):
    e = refused(lambda: tactor.Client(tmp_path / "none.sock"), FileNotFoundError)
    assert isinstance(e, tactor.DeviceError) and e.file == str(tmp_path / "none.sock") and "tactor serve" in e.hint
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with pytest.raises(tactor.DeviceError, match="tactor.sock"):
        tactor.Client()


def test_a_service_that_is_too_far_or_at_no_possible_place_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr("tactor._client._HELLO_S", 0.2)
    with contextlib.ExitStack() as held:
        full = held.enter_context(socket.create_server(("127.0.0.1", 0), backlog=0))
        with pytest.raises(TimeoutError):  # once its queue is full, the kernel answers no more
            for _ in range(8):
                held.enter_context(socket.create_connection(full.getsockname(), 0.2))
        e = refused(lambda: tactor.Client(tcp=f"127.0.0.1:{full.getsockname()[1]}"), TimeoutError)
    assert isinstance(e, tactor.DeviceError) and (e.errno, e.why) == (errno.ETIMEDOUT, os.strerror(errno.ETIMEDOUT))
    e = refused(lambda: tactor.Client(tmp_path / ("x" * 200)), tactor.DeviceError)
    assert (e.errno, e.why) == (errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))


def test_a_name_without_an_address_is_an_error_in_the_resolvers_words(monkeypatch):
    def resolve(*_, **__):
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")
    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    e = refused(lambda: tactor.Client(tcp="nobody.invalid:4001"), tactor.DeviceError)
    assert (e.errno, e.why) == (0, "Name or service not known")


def test_a_service_says_why_it_ends_a_connection(tmp_path, endless):
    with serving(tmp_path, "max_clients = 1") as (path, _):
        with tactor.Client(path) as c:
            e = refused(lambda: tactor.Client(path), tactor.StreamError)
            assert e.what == "max_clients" and "places for clients are taken" in e.why and e.hint == "try again later"
            stroke = c.play(endless, algorithm="continuous")
            c.status().wait(LONG)
            whys = {refused(lambda: call().wait(LONG), tactor.Error).why
                    for call in (lambda: c.call("status", x="a" * 1_100_000), lambda: stroke, c.status)}
            assert len(whys) == 1 and "ended" not in whys.pop()


def test_a_closed_client_says_so(service, endless):
    c = tactor.Client(service)
    stroke = c.play(endless, algorithm="continuous")
    c.status().wait(LONG)
    c.close()
    for call in (lambda: stroke.wait(LONG), c.status, c.stop):
        e = refused(call, tactor.StreamError)
        assert (e.what, e.why) == ("client", "it is closed")


def test_live_takes_the_options_of_a_player_but_those_that_it_names(client):
    exceptions = tactor.Client.live.__doc__.split("except ")[1].split(".")[0].replace(" and ", ", ").split(", ")
    known = re.findall(r"\w+", refused(lambda: client.live(tempo=3)).hint)
    for name in inspect.signature(tactor.Player.live).parameters.keys() - inspect.signature(tactor.Client.live).parameters.keys():
        assert (name in known) != (name in exceptions), name


def test_a_service_that_ends_wakes_waiting_calls(tmp_path, endless):
    with serving(tmp_path) as (path, server):
        c = tactor.Client(path)
        stroke = c.play(endless, algorithm="continuous")
        c.status().wait(LONG)
        server.kill()
        with pytest.raises(tactor.StreamError, match="has ended"):
            stroke.wait(LONG)
    refused(lambda: c.play(endless), tactor.StreamError)
    assert c.closed and "closed" in repr(c)
    c.close()


def test_a_forgotten_client_is_closed(service):
    c = tactor.Client(service)
    thread = c._wire.thread
    del c
    gc.collect()
    thread.join(LONG)
    assert not thread.is_alive()
