# SPDX-License-Identifier: MIT
"""The participant's page of tactor experiment on the wire: the messages, the answers that count, and the clients that may.
tests/study has the dialogue, tests/cli/test_serve_web.py the server of a page."""
import json
import math
import re
import signal
import socket
import statistics
import urllib.request

from experiments import ADJUST, DRAWINGS, ESTIMATES, IDENTIFY, LINE, SHORT, WITH_CONSENT, read_table
from harness import main
from pages import PageTest, Session
from studies import toml
from websocket import BINARY, TEXT, Peer, framed


class Sessions(PageTest):
    def test_a_whole_session_on_the_page(self):
        s = self.start()
        self.assertRegex(s.address, r"^127\.0\.0\.1:[1-9]\d*$")
        p = s.participant()
        self.assertEqual(p.facts["tactors"], [[0, 0], [20, 0]])
        asked = p.answer("consent", 1)
        self.assertEqual((asked["text"], asked["question"], asked["choices"]), ("Be at ease.", "Do you agree?", ["Yes", "No"]))
        self.assertEqual(len(p.answer("walk", 3)["choices"]), 3)  # once more
        p.answer("walk", 1)
        self.assertEqual(len(p.answer("walk", 4)["choices"]), 4)  # the one before
        p.walk()
        asked = p.answer("introduce", 1)
        self.assertEqual((asked["question"], asked["progress"]),
                         ("Which one?", {"run": 1, "runs": 2, "practice": False, "trial": 0, "trials": 2}))
        self.assertTrue(p.answer("question", 1)["progress"]["practice"])
        for i in (1, 2):
            target = p.until("target", asked=False)
            self.assertEqual(target["lasts_s"], 0.2)
            self.assertLess(target["passed_s"], 0.2)
            self.assertEqual({tuple(target["paths"][0][0]), tuple(target["paths"][0][-1])}, {(0, 0), (20, 0)})
            p.until("stimulus", asked=False)
            asked = p.answer("question", i)
            self.assertEqual((asked["choices"], asked["progress"]["trial"]), (["", ""], i))
        rest = p.until("rest", asked=False)
        self.assertEqual(rest["lasts_s"], 0.3)
        p.answer("introduce", 1)
        for _ in (1, 2):
            asked = p.answer("question", 3)
            self.assertEqual((asked["question"], asked["choices"]), ("How even?", ["not", "half", "all"]))
        p.until("over", asked=False)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual(self.answers(), [("1", "1", "false", "1"), ("2", "1", "false", "2")])
        self.assertEqual([r["rating"] for r in self.rows("01", "marks")], ["3", "3"])
        self.assertEqual(len(read_table(self.dir / "study/sourcedata/sub-01/practice.tsv")), 1)
        self.assertEqual([x["display"] for x in self.session()["streams"]], ["page"])
        self.assertGreaterEqual(min(float(r["response_time"]) for r in self.rows("01", "pairs")), 0)
        # The experimenter reads the answers; neither reads the method, and the participant not even the title.
        self.assertIn("Trial 2/2: Which one? 1 or 2: 2", s.shown)
        self.assertNotIn("cannot be drawn", s.said)
        for text in (json.dumps(p.seen), s.shown, re.sub(r'tactor: warning: motion ".*', "", s.said)):
            self.assertNotRegex(text, "(?i)alder|birch|tactile-brush|park")
        self.assertNotIn("east", json.dumps(p.seen))
        # The page gets which of two stimuli plays, and the same for both methods.
        told = {}
        for m in p.seen:
            if m.get("screen") == "stimulus":
                where = m["progress"]
                told.setdefault((where["run"], where["practice"], where["trial"]), []).append((m.get("stimuli"), m.get("playing")))
        pair = [(2, 0), (2, 1), (2, 0), (2, 2)]
        self.assertEqual(told, {(1, True, 1): pair, (1, False, 1): pair, (1, False, 2): pair,
                                (2, False, 1): [(None, None)], (2, False, 2): [(None, None)]})
        self.assertEqual({r["method_1"] for r in self.rows("01", "marks")}, {"Alder", "Birch"})
        marks = [m for m in p.seen if m.get("progress", {}).get("run") == 2 and m["progress"]["trial"]]
        for m in marks:
            del m["progress"], m["ask"]
        self.assertEqual(marks[:len(marks) // 2], marks[len(marks) // 2:])

    def test_an_estimate_is_any_positive_number(self):
        self.write("sizes.toml", ESTIMATES)
        s, p = self.start_both(definition="sizes.toml")
        p.begin(agrees=False)
        for refused, number in (("12,5", "0.5"), ("0", "12.50"), ("-1", "1500"), ("1" * 40, ".25")):
            asked = p.until("question")
            self.assertEqual(asked["entry"], {"lowest": 1e-11, "greatest": 1e12, "longest": 12})
            p.say(ask=asked["ask"], text=refused)
            self.assertEqual(p.until("question")["ask"], asked["ask"])
            p.say(ask=asked["ask"], text=number)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["intensity_estimate"] for r in self.rows("01", "size")], ["0.5", "12.5", "1500", "0.25"])

    def test_a_comparison_is_moved_by_buttons(self):
        self.write("equal.toml", ADJUST)
        s, p = self.start_both(definition="equal.toml")
        p.begin(agrees=False)
        told = []
        for trial in range(4):
            for choice in (4, 3, 5, 2, 1, 6):
                asked = p.answer("question", choice)
                self.assertEqual((asked["choices"], asked["question"], asked["progress"]["trial"]),
                                 (["Much less", "Less", "More", "Much more", "Once more", "They are equal"], "Make both feel equal.", trial + 1))
                self.assertEqual(set(asked), {"screen", "ask", "text", "question", "choices", "progress"})  # nothing tells the value
            told.append(asked["text"])
        self.assertEqual(s.end(), 0, s.said)
        rows = self.rows("01", "equal")
        self.assertEqual([(float(r["start"]), float(r["value"]), r["moves"]) for r in rows],
                         [(v, {-40: -40, -22: -26}[v], {-40: "4", -22: "3"}[v]) for v in (float(r["start"]) for r in rows)])
        self.assertEqual(told, [f"You change the {'second' if r['method_1'] == 'standard' else 'first'} one." for r in rows])
        self.assertEqual({(r["start"], r["method_1"]) for r in rows}, {(v, m) for v in ("-40.000000", "-22.000000") for m in ("standard", "Birch")})

    def test_a_drawing_is_kept_as_it_was_drawn(self):
        self.write("drawn.toml", DRAWINGS)
        s, p = self.start_both(definition="drawn.toml")
        p.begin(agrees=False)
        path = [[0, 0, 1.234], [0.0104, 5, 1.5], [0.0104, 5.25, -0.001], [1.5, 20, 2]]
        for kind, good in (("place", [[0, 9.875, -3]]), ("place", [[0, 0, 0]]), ("place", [[0, 1e4, 1]]), ("path", path), ("path", [[0, 1, 1]])):
            asked = p.until("question")
            self.assertEqual(asked["entry"], {"draw": kind, "most": 600})
            for bad in ([], {}, None, [[0, 1]], [[0, 1, 2, 3]], [[0, "1", 2]], [[0, None, 2]], [[-1, 1, 2]], [[0, 1e5, 2]], [[1, 0, 0], [0, 0, 0]],
                        [[0, 0, 0]] * 601, *([path] if kind == "place" else [])):
                p.say(ask=asked["ask"], drawing=bad)
                self.assertEqual(p.until("question")["ask"], asked["ask"])
            p.say(ask=asked["ask"], answer=1)
            self.assertEqual(p.until("question")["ask"], asked["ask"])
            p.say(ask=asked["ask"], drawing=good)
            if (kind, good[0][1]) == ("place", 1e4):
                p.answer("introduce", 1)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([(r["response"], r["target"]) for r in self.rows("01", "where")],
                         [(place, "0 10 0") for place in ("0 9.88 -3", "0 0 0", "0 10000 1")])
        rows = self.rows("01", "how")
        self.assertEqual([r["response"] for r in rows], ["0 0 1.23;0.01 5 1.5;0.01 5.25 0;1.5 20 2", "0 1 1"])
        for r in rows:
            points = [tuple(map(float, p.split())) for p in r["target"].split(";")]
            self.assertEqual((points[0], points[25], points[-1], len(points)), ((0, 0, 0), (0.1, 10, 0), (0.2, 20, 0), 51))
        told = self.analysis()["runs"]
        # By hand: the middle is 10, 0.
        at = [(9.88, -3), (0, 0), (10000, 1)]
        person = told["where"]["drawings"]["participants"]["01"]
        self.assertAlmostEqual(person["error"], sum(math.hypot(x - 10, y) for x, y in at) / 3, 9)
        self.assertAlmostEqual(person["constant_across"], sum(x - 10 for x, _ in at) / 3, 9)
        self.assertAlmostEqual(person["variable_along"], statistics.stdev(y for _, y in at), 9)
        self.assertEqual(told["where"]["drawings"]["target"], [[10, 0]])
        # A drawing of one point has no direction; the mean is over those that have one.
        self.assertAlmostEqual(told["how"]["drawings"]["participants"]["01"]["direction"], math.degrees(math.atan2(2 - 1.23, 20)), 9)
        self.assertEqual(len(told["how"]["drawings"]["mean"]), 51)
        # Both observers feel the stroke on the line between the tactors.
        for drawings in (told["where"]["drawings"], told["how"]["drawings"]):
            self.assertEqual(list(drawings["predicted"]), ["centroid", "low-speed"])
            for one in drawings["predicted"].values():
                self.assertTrue(all(y == 0 and 0 <= x <= 20 for x, y in one["points"]), one)
                if len(one["points"]) == 1:
                    self.assertAlmostEqual(one["distance"], math.dist(one["points"][0], drawings["mean"][0]), 9)
                else:
                    self.assertGreaterEqual(one["frechet"], one["distance"])
        file = self.dir / "study/sourcedata/sub-01/session.json"
        kept = file.read_text()
        file.write_text(kept.replace('"felt": "0 ', '"felt": "x ', 1))
        self.assertIn("predictions[0].felt: it is not a drawing", self.refused(2, "analyze", "study").stderr)
        file.write_text(re.sub(r'"predictions": \[.*?\],', "", kept, flags=re.S))  # as of another program
        self.assertEqual(self.analysis()["runs"]["how"]["drawings"]["predicted"], {})
        self.write_row("how", 0, "response", "0 1 1;x")
        self.assertIn('sub-01_task-how_beh.tsv:2: response is not a drawn path', self.refused(2, "analyze", "study").stderr)
        self.assertIn("participants can draw only on the page", self.refused(2, *self.args(code="02", definition="drawn.toml")).stderr)

    def write_row(self, task, row, column, text):
        file = self.dir / f"study/sub-01/beh/sub-01_task-{task}_beh.tsv"
        lines = [line.split("\t") for line in file.read_text().splitlines()]
        lines[row + 1][lines[0].index(column)] = text
        file.write_text("".join("\t".join(line) + "\n" for line in lines))

    def test_motions_to_name_have_pictures_and_words_are_in_the_participant_s_language(self):
        words = '[page]\nlanguage = "de"\nagree = "Machen Sie mit?"\nyes = "Ja"\npause = "Pause"\n'
        self.write("de.toml", WITH_CONSENT.replace("[[motion]]", words + "[[motion]]", 1) + IDENTIFY)
        s, p = self.start_both(definition="de.toml")
        self.assertEqual((p.facts["words"]["language"], p.facts["words"]["pause"]), ("de", "Pause"))
        asked = p.answer("consent", 1)
        self.assertEqual((asked["question"], asked["choices"]), ("Machen Sie mit?", ["Ja", "No"]))
        p.walk()
        p.answer("introduce", 1)
        for i in (1, 2):
            asked = p.answer("question", i)
            self.assertEqual(asked["choices"], ["east", "west"])
            self.assertEqual([(way[0], way[-1]) for [way] in asked["pictures"]], [([0, 0], [20, 0]), ([20, 0], [0, 0])])
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([m["progress"]["trial"] for m in p.seen if m.get("screen") == "walk" and m["ask"]], [1, 2])
        self.write("de.toml", SHORT.replace("[[motion]]", '[page]\nagre = "x"\n[[motion]]', 1))
        self.refused(2, *self.args(definition="de.toml"))

    def test_a_line_has_an_answer_for_each_place_and_stimuli_have_the_words_of_their_answers(self):
        words = ["the first", "the second"]
        self.write("line.toml", LINE + toml("run", "pairs", task="choose", attribute="similarity", trials=2, choices=words))
        s, p = self.start_both(definition="line.toml")
        p.begin()
        for place in (1, 101, 58, 2):
            asked = p.answer("question", place)
            self.assertEqual((asked["visual"], asked["choices"]), (True, ["not", *[""] * 99, "all"]))
        p.answer("introduce", 1)
        for i in (1, 2):
            self.assertEqual(p.answer("question", i)["choices"], words)
        p.until("over", asked=False)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([(m["playing"], m["names"]) for m in p.seen if m.get("stimuli")], [(playing, words) for playing in (0, 1, 0, 2)] * 2)
        self.assertEqual([row[3] for row in self.answers("marks", "rating")], ["0", "100", "57", "1"])
        self.assertEqual([row[3] for row in self.answers()], ["1", "2"])

    def test_the_experimenter_s_keys_work(self):
        s, p = self.start_both()
        p.begin()
        p.answer("question", 1)  # practice
        p.until("question")
        s.key("r")
        s.told("trial 1 is void: the experimenter repeated it")
        p.until("question")
        s.key("1")  # the participant answers, not the experimenter
        s.key("p")
        s.told("a pause comes")
        p.say(ask=p.seen[-1]["ask"], answer=2)
        p.until("pause", asked=False)
        s.key("g")
        p.until("question")
        s.key("v")
        s.told("trial 2 is void: the experimenter made it void")
        p.say(ask=p.seen[-1]["ask"], answer=1)
        p.answer("question", 1)
        p.until("rest", asked=False)
        s.key("g")
        p.until("introduce")
        s.key("g")  # begins, too
        p.until("question")
        s.key("q")
        p.until("over", asked=False)
        self.assertEqual(s.end(), 130)
        self.assertEqual(self.answers(), [("1", "1", "true", "n/a"), ("2", "1", "true", "2"), ("1", "2", "false", "1"),
                                          ("2", "2", "false", "1")])

    def test_a_tactor_that_is_not_felt_ends_the_session(self):
        s, p = self.start_both()
        p.answer("consent", 1)
        p.answer("walk", 2)
        p.answer("walk", 2)  # the first No offers it once more
        p.until("over", asked=False)
        self.assertEqual(s.end(), 1)
        self.assertIn("tactor 0: it was not felt", s.said)


class OnceAndNoMore(PageTest):
    def test_reloads_second_pages_doubled_and_late_answers(self):
        s, p = self.start_both()
        p.begin()
        old = p.until("question")["ask"]
        # The practice's answer again, and one from before the question: neither is the first trial's. All at once, since the
        # question may come later.
        p.send(b"".join(framed(TEXT, json.dumps({"ask": ask, "answer": answer}).encode())
                        for ask, answer in ((old, 1), (old, 2), (old + 1, 2))))
        p.until("stimulus", asked=False)
        # A reload in mid-trial gets the present state, a second page too: the first is notified, and its answer does not count.
        p.socket.close()
        first = s.participant()
        ask = first.next()["ask"] or first.until("question")["ask"]
        p = s.participant()
        self.assertEqual(p.next()["ask"], ask)
        while first.seen[-1] != {"screen": "elsewhere"}:
            first.next()
        first.say(ask=ask, answer=1)
        self.assertEqual(first.end(), 1001)
        for answer in (2, 1, 2):
            p.say(ask=ask, answer=answer)
        self.assertEqual(p.until("question")["progress"]["trial"], 2)
        # Without a page the question waits.
        p.socket.close()
        p = s.participant()
        p.answer("question", 1)
        p.until("rest", asked=False)
        s.process.send_signal(signal.SIGINT)
        self.assertEqual(s.end(), 130)
        self.assertEqual(self.answers(), [("1", "1", "false", "2"), ("2", "1", "false", "1")])

    def test_a_target_shown_on_no_page_makes_its_trial_void(self):
        s, p = self.start_both()
        p.answer("consent", 1)
        p.walk()
        p.until("introduce")
        p.socket.close()
        urllib.request.urlopen(f"http://{s.address}/").read()  # it has been noticed, then
        s.key("g")
        s.told(r"(?s)(trial 1 is void: no page showed the target.*){2}")  # the practice's, and the first
        p = s.participant()
        while (now := p.next())["screen"] != "over":
            if now["screen"] == "pause":
                s.key("g")  # after five in a row
            elif now["ask"]:
                p.say(ask=now["ask"], answer=min(2, len(now["choices"])))
        self.assertEqual(s.end(), 0, s.said)
        rows = self.answers()
        self.assertEqual(rows[0], ("1", "1", "true", "n/a"))
        self.assertEqual(sorted((r[0], r[3]) for r in rows if r[2] == "false"), [("1", "2"), ("2", "2")])

    def test_a_killed_session_resumes_at_the_next_trial(self):
        s, p = self.start_both()
        p.begin()
        p.answer("question", 1)
        p.answer("question", 2)
        p.until("question")
        s.process.send_signal(signal.SIGKILL)
        s.end()
        self.assertEqual(self.answers(), [("1", "1", "false", "2")])
        s, p = self.start_both("--resume")
        p.begin(agrees=False)
        self.assertEqual(p.answer("question", 1)["progress"]["trial"], 2)
        p.until("rest", asked=False)
        s.process.send_signal(signal.SIGINT)
        self.assertEqual(s.end(), 130)
        self.assertEqual(self.answers(), [("1", "1", "false", "2"), ("2", "1", "false", "1")])

    def test_nonsense_is_refused(self):
        s = self.start()
        for kind, text, code in ((TEXT, b"{", 1008), (TEXT, b'{"answer":-1,"ask":1}', 1008), (BINARY, b"{}", 1003), (TEXT, b" " * 17000, 1009)):
            p = s.participant()
            p.until("consent")
            p.frame(kind, text)
            self.assertEqual(p.end(), code)


class WhoMay(PageTest):
    def test_the_page_is_one_document_for_this_machine_s_browsers(self):
        s = self.start()
        port = s.address.rpartition(":")[2]

        def peer():
            p = Peer(s.address)
            self.addCleanup(p.socket.close)
            return p
        p = peer()
        status, headers = p.request()
        self.assertEqual((status, headers["content-type"]), (200, "text/html; charset=utf-8"))
        self.assertTrue(headers["content-security-policy"].startswith("default-src 'none'; "))
        self.assertFalse(re.findall(r"(?:src|href)=\"(?!data:,)", p.body(headers).decode()))
        for host, status in ((f"localhost:{port}", 200), ("localhost", 403), (f"evil.example:{port}", 403), (f"127.0.0.2:{port}", 403)):
            self.assertEqual(peer().request(host=host)[0], status, host)
        for origin, status in ((f"http://{s.address}", 101), ("null", 403), (f"http://localhost:{port}", 403)):
            self.assertEqual(peer().upgrade(Origin=origin), status, origin)
        for target, status in (("/rpc", 426), ("/status", 404), ("/x", 404)):
            self.assertEqual(peer().request(target)[0], status, target)

    def test_exclusive_options_are_refused(self):
        for more in ("--page 0.0.0.0:0", "--page 4:4:4", "--page 0 --display terminal", "--display wall", "--page 0 --simulate seed=1"):
            self.refused(2, *self.args(*more.split()))
        s = self.start()
        self.refused(3, *self.args("--page", s.address.rpartition(":")[2]), says=("--page", s.address))
        self.assertFalse((self.dir / "study/sourcedata").exists())

    def test_a_page_on_ipv6(self):
        try:
            with socket.socket(socket.AF_INET6) as probe:
                probe.bind(("::1", 0))
        except OSError:
            self.skipTest("this machine has no IPv6")
        self.assertRegex(Session(self, self.args("--page", "[::1]:0")).address, r"^\[::1\]:")


if __name__ == "__main__":
    main()
