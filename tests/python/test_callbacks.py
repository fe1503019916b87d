# SPDX-License-Identifier: MIT
"""Callbacks and signal handlers, with any content and at any time."""
import gc
import os
import textwrap
import warnings

import pytest

import tactor
from test_player import run


class Experiment:
    """An object that has a player and hands it its own methods, as programs do."""

    def __init__(self, palm, score, with_log):
        self.lines, self.ended = [], []
        self.player = tactor.Player("null", palm, config=os.devnull, log=self.log if with_log else None)
        self.ticket = self.player.submit(score)
        self.ticket.add_done_callback(self.done)

    def log(self, kind, text):
        self.lines.append(text)

    def done(self, ticket):
        self.ended.append(ticket.report.state)


@pytest.mark.parametrize("with_log", [False, True])
def test_bound_methods_do_not_keep_a_forgotten_player_alive(palm, endless, with_log):
    experiment = Experiment(palm, endless, with_log)
    thread, ended = experiment.player._shared.thread, experiment.ended
    with pytest.warns(ResourceWarning, match="unclosed"):
        del experiment
        gc.collect()
    assert not thread.is_alive()
    assert ended == ["cancelled"]


def test_a_log_without_other_references_gets_its_lines(palm, short):
    lines = []

    class Log:
        def told(self, kind, text):
            lines.append(kind)
    with tactor.Player("null", palm, config=os.devnull, log=Log().told) as p:
        gc.collect()
        p.play(short)
        p.stop()
    assert lines


def test_a_ticket_outlives_a_player_that_was_forgotten(palm, endless):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        ticket = tactor.Player("null", palm, config=os.devnull).submit(endless)
        gc.collect()
    assert ticket.wait(60).state == "cancelled"


HANDLER = """
    import os, signal, sys, threading, time
    import tactor
    palm = tactor.Array.preset("palm-3x3")
    stroke = tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=0.02)
    score = tactor.Score(palm, tactor.plan(palm, stroke, algorithm="continuous"), level_dbfs=-60)
    player = tactor.Player("null", palm)

"""


def test_strokes_may_be_submitted_in_a_signals_handler():
    """Submits at any moment, also while the program itself submits, waits or adds a callback."""
    code, out, err = run(HANDLER + """
    fired = []
    def handler(*_):
        if len(fired) < 400:
            fired.append(player.submit(score))
            fired[-1].add_done_callback(lambda t: None)
            signal.setitimer(signal.ITIMER_REAL, 0.0007)  # not before: handlers would nest on a slow machine
    signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.002)
    while len(fired) < 400:
        ticket = player.submit(score)
        ticket.add_done_callback(lambda t: None)
        ticket.wait(60)
    print({t.wait(60).state for t in fired})
    player.close()
    """)
    assert (code, out.strip(), err) == (0, "{'finished'}", "")


@pytest.mark.parametrize("what", ["player.close()", "player.stop()", "ticket.wait(60)", "ticket.cancel()"])
def test_players_may_be_ended_in_a_signals_handler(what):
    code, out, err = run(HANDLER + textwrap.indent(textwrap.dedent(f"""
    calls, within = [], []
    def handler(*_):
        calls.append(1)
        if len(calls) == 300:
            signal.setitimer(signal.ITIMER_REAL, 0)  # where a handler takes longer than the time between two, nothing else goes on
        if len(within) == 20:
            return  # with a load the signals overtake their handlers, which interrupt each other up to Python's recursion limit
        within.append(1)
        try:
            {what}
        except tactor.StreamError:
            pass  # it is closed
        finally:
            within.pop()
    tickets = [player.submit(score) for _ in range(4)]
    ticket = tickets[-1]
    signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.002, 0.0007)
    for t in tickets:
        t.wait(60)
    while not calls:
        time.sleep(0.001)
    player.close()
    signal.setitimer(signal.ITIMER_REAL, 0)  # not by ignoring it: Python complains about one that is on its way
    print(player.closed, bool(calls), player.ended)
    """), "    "))
    assert (code, out.split()[:2], err) == (0, ["True", "True"], "")
