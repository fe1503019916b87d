# SPDX-License-Identifier: MIT
"""Tables of tactor experiment left by a crash, an editor, a spreadsheet, R or pandas: which resume, which are refused."""
import re
import shutil

from experiments import COLUMNS, ExperimentTest, contents, read_table
from harness import main


class Tables(ExperimentTest):
    def broken_off(self):
        """Makes a session in its second run with two answered trials; returns the bytes of the whole one, and the tables."""
        for folder in ("whole", "study"):
            shutil.rmtree(self.dir / folder, ignore_errors=True)
        self.simulate(folder="whole")
        whole = contents(self.dir / "whole")
        shutil.copytree(self.dir / "whole", self.dir / "study")
        self.forget_last_run()
        table = self.dir / "study/sub-01" / read_table(self.dir / "study/sub-01/sub-01_scans.tsv")[-1]["filename"]
        table.write_text("".join(table.read_text().splitlines(True)[:3]))
        return whole, table, sorted((self.dir / "study").rglob("*.tsv"))

    def test_tables_saved_by_another_program_resume_and_keep_their_line_ends(self):
        def pandas(text):
            return text.replace(b"false", b"False").replace(b"n/a", b"").replace(b"\t1\t1\t", b"\t1.0\t1.0\t")

        def r(text):
            return re.sub(rb"[^\t\n]+", lambda m: b'"' + m[0] + b'"', text.replace(b"false", b"FALSE")).replace(b'"n/a"', b"NA")
        for way in (lambda t: t.replace(b"\n", b"\r\n"), lambda t: t[:-1].replace(b"\n", b"\r"), lambda t: b"\xef\xbb\xbf" + t + b"\n\t\t\n\n", pandas, r):
            whole, _, tables = self.broken_off()
            saved = {p: way(p.read_bytes()) for p in tables}
            for path, data in saved.items():
                path.write_bytes(data)
            self.assertEqual(self.analysis()["participants"], 1)
            self.assertNotIn("cut", self.simulate("01", "--resume").stderr)
            self.assertEqual(set(contents(self.dir / "study")), set(whole))
            for path, data in saved.items():
                new = path.read_bytes()
                self.assertTrue(new.startswith(data), path)
                if b"\r" in data:
                    self.assertEqual(new.count(b"\n"), new.count(b"\r\n"))
            self.assertEqual(self.ok("analyze", "study", "--format", "tsv").stdout, self.ok("analyze", "whole", "--format", "tsv").stdout)
            self.ok("report", "study")
            self.assertIn("finished", self.simulate("01", "--resume").stdout)
            self.simulate("02")
            self.assertTrue((self.dir / "study/participants.tsv").read_bytes().startswith(saved[self.dir / "study/participants.tsv"]))

    def test_unreadable_tables_are_refused_before_the_session_and_left_alone(self):
        _, _, tables = self.broken_off()
        for way, says in ((lambda t: t.replace(b"\t", b";"), ":1: semicolons separate the columns"),
                          (lambda t: t.decode().encode("utf-16-le"), ": it is UTF-16"),
                          (lambda t: t.replace(b"\n", b"\nx\n", 1), ":2: the line has 1 column, not ")):
            for path in tables:
                good = path.read_bytes()
                path.write_bytes(way(good))
                before = contents(self.dir / "study")
                with self.subTest(says + path.name):
                    commands = [("experiment", self.small(), "--participant", "01", "-o", "study", "--simulate", "seed=1,sigma=1", "--resume")]
                    if path.name == "participants.tsv":
                        commands += [("experiment", self.small(), "--participant", "02", "-o", "study", "--simulate", "seed=1,sigma=1")]
                    if not path.name.endswith("scans.tsv") and path.name != "practice.tsv":
                        commands += [("analyze", "study")]
                    for command in commands:
                        self.refused(2, *command, says=(path.name + says,))
                    self.assertEqual(contents(self.dir / "study"), before)
                path.write_bytes(good)

    def test_resume_and_analysis_refuse_the_same(self):
        whole, _, _ = self.broken_off()
        table = self.dir / "study/sub-01/beh/sub-01_task-whichone_beh.tsv"
        good = table.read_text()
        lines = good.split("\n")
        for column, value in (("response", "9"), ("void", "n/a"), ("onset", "1e"), ("onset", "0,000"), ("duration", "0,3"), ("plan_1", "x"), ("", "")):
            cells = lines[1].split("\t")
            if column:
                cells[COLUMNS.index(column)] = value
                table.write_text("\n".join([lines[0], "\t".join(cells), *lines[2:]]))
            else:  # a column is missing
                table.write_text(good.replace("\tvoid", "\tother", 1))
            before = contents(self.dir / "study")
            self.simulate("01", "--resume", status=2)
            if column != "plan_1":  # the analysis does not know the plans
                self.refused(2, "analyze", "study")
                self.refused(2, "report", "study")
            self.assertEqual(contents(self.dir / "study"), before)
        table.write_text(good)
        people = self.dir / "study/participants.tsv"
        text = people.read_text()
        people.write_text(text.replace("participant_id", "id"))
        self.simulate("02", status=2)
        people.write_text(text)
        self.simulate("01", "--resume")
        self.assertEqual(contents(self.dir / "study"), whole)

    def test_a_cut_off_line_is_kept_beside_its_table_and_reported(self):
        whole, table, _ = self.broken_off()
        practice = self.dir / "study/sourcedata/sub-01/practice.tsv"
        lines = practice.read_bytes().splitlines(True)
        practice.write_bytes(b"".join(lines[:-1]) + lines[-1][:40])
        text = table.read_bytes()
        table.write_bytes(text[:-100])
        cut = text[:-100].rpartition(b"\n")[2]
        self.refused(2, "analyze", "study", says=(f"{table.name}:3: the last line is incomplete (run tactor experiment --resume",))
        said = self.simulate("01", "--resume").stderr
        for path, kept in ((table, cut), (practice, lines[-1][:40])):
            name = path.relative_to(self.dir)
            self.assertIn(f"tactor: warning: {name}: its last line was incomplete and was moved to {name}.cut-1\n", said)
            self.assertEqual(path.with_name(path.name + ".cut-1").read_bytes(), kept)
        whole[str(practice.relative_to(self.dir / "study"))] = b"".join(lines[:-1])  # that run is over: no more practice
        self.assertEqual(self.without_cut(), whole)
        self.assertEqual((self.dir / "study/.bidsignore").read_text(), "*.cut-*\n")
        self.ok("analyze", "study")
        # Once more: nothing kept is replaced, nothing ignored twice.
        table.write_bytes(table.read_bytes()[:-30])
        self.forget_last_run()
        (self.dir / "study/.bidsignore").write_text("mine")
        self.simulate("01", "--resume")
        self.assertEqual(table.with_name(table.name + ".cut-1").read_bytes(), cut)
        self.assertTrue(table.with_name(table.name + ".cut-2").exists())
        self.assertEqual((self.dir / "study/.bidsignore").read_text(), "mine\n*.cut-*\n")
        self.assertEqual(self.without_cut(), whole)

    def test_a_finished_session_is_never_sent_to_resume(self):
        self.simulate()
        table = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        text = table.read_text()
        table.write_text(text[:-1])
        self.ok("analyze", "study")
        before = contents(self.dir / "study")
        self.assertIn("finished", self.simulate("01", "--resume").stdout)
        self.assertEqual(contents(self.dir / "study"), before)
        table.write_text(text + "0.5\t")
        before = contents(self.dir / "study")
        for refusal in (self.refused(2, "analyze", "study"), self.simulate("01", "--resume", status=2)):
            self.assertNotIn("--resume", refusal.stderr)
        self.assertEqual(contents(self.dir / "study"), before)

    def test_missing_lists_are_reported_and_begun_anew(self):
        whole, _, _ = self.broken_off()
        people, scans = self.dir / "study/participants.tsv", self.dir / "study/sub-01/sub-01_scans.tsv"
        for name in (people, scans):
            name.unlink()
        said = self.simulate("01", "--resume").stderr
        for name in (people, scans):
            self.assertIn(f"tactor: warning: {name.relative_to(self.dir)}: it is missing, so a new one begins (restore the old one", said)
        after = contents(self.dir / "study")
        self.assertEqual({n for n in whole if whole[n] != after.get(n)}, {"sub-01/sub-01_scans.tsv"})
        self.assertEqual([s["filename"] for s in read_table(scans)],
                         [line.split("\t")[0] for line in whole["sub-01/sub-01_scans.tsv"].decode().splitlines()[1:]])
        self.assertEqual([s["acq_time"] for s in read_table(scans)][:2], ["n/a", "n/a"])
        self.ok("analyze", "study")

    def test_a_participant_removed_from_the_lists_is_reported(self):
        whole, _, _ = self.broken_off()
        people = self.dir / "study/participants.tsv"
        people.write_text(people.read_text().splitlines(True)[0])
        said = self.simulate("01", "--resume").stderr
        self.assertIn("study/participants.tsv: sub-01 was missing and was added again", said)
        self.assertEqual(contents(self.dir / "study"), whole)

    def test_columns_in_another_order_take_a_session_by_their_names(self):
        _, _, tables = self.broken_off()
        for path in tables:
            rows = [line.split("\t") for line in path.read_text().splitlines()]
            path.write_text("".join("\t".join([*row[::-1], "note" if row is rows[0] else "mine"]) + "\n" for row in rows))
        self.simulate("01", "--resume")
        for path in tables:
            own, first = read_table(path), read_table(self.dir / "whole" / path.relative_to(self.dir / "study"))
            self.assertEqual([{k: v for k, v in row.items() if k != "note"} for row in own], first)
            self.assertIn(own[-1]["note"], ("n/a", "mine"))
        self.simulate("02")
        self.assertEqual((self.dir / "study/participants.tsv").read_text().splitlines()[-1], "n/a\tn/a\tn/a\tsub-02\tn/a")
        self.ok("analyze", "study")


if __name__ == "__main__":
    main()
