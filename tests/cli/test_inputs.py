# SPDX-License-Identifier: MIT
"""Output never replaces an input of the command, under any name or link, nor, without --force, a file of another program."""
import os
import struct
import subprocess

from experiments import ExperimentTest, contents
from harness import GRID, PATIENCE_S, TOOL, main, wav_bytes

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40"><path d="M 0 20 L 40 20"/></svg>"""
CSV = "t_s,x_mm,y_mm\n0,0,20\n1,40,20\n"
TOML = '[stroke]\npath = "M 0 20 L 40 20"\n'
ARRAY = GRID.replace("rows = 1", "rows = 3").replace("columns = 2", "columns = 3")
TONE = wav_bytes([(k % 64 - 31.5) / 32 for k in range(64)])


class OverInput(ExperimentTest):
    def setUp(self):
        super().setUp()
        self.write("s.svg", SVG)
        self.write("s.csv", CSV)
        self.write("s.toml", TOML)
        self.write("a.toml", ARRAY)
        self.write("c.toml", "[output]\nrate = 48000\n")
        self.write("tex.wav", TONE)
        self.write("tex.toml", '[stroke]\npath = "M 0 20 L 40 20"\nwaveform = "tex.wav"\n')
        self.write("p.json", self.ok("plan", "s.toml", "--format", "json").stdout)

    def names(self, file, extension):
        """Returns the file under its name, where that has the extension, and as links of both kinds."""
        if file.endswith(extension):
            yield file
            yield f"./../{self.dir.name}/{file}"
        for link, make in (("hard", os.link), ("soft", os.symlink)):
            name = f"{link}{extension}"
            (self.dir / name).unlink(missing_ok=True)
            make(self.dir / file, self.dir / name)
            yield name

    def kept(self, file, extension, *args, force=True):
        """Checks that no form of the command writes over the file."""
        before = (self.dir / file).read_bytes()
        for name in self.names(file, extension):
            for more in ((), ("--force",)) if force else ((),):
                with self.subTest(args=args, output=name, more=more):
                    says = ["input"] if more else [name]
                    self.refused(2, *args, "-o", name, *more, says=says)
                    self.assertEqual((self.dir / file).read_bytes(), before)

    def test_pictures_do_not_replace_their_inputs(self):
        for extension in (".svg", ".png", ".pdf"):
            for file, args in (("s.svg", ("s.svg",)), ("s.csv", ("s.csv",)), ("s.toml", ("s.toml",)), ("p.json", ("p.json",)),
                               ("a.toml", ("s.toml", "--array", "a.toml")), ("c.toml", ("s.toml", "--config", "c.toml")),
                               ("tex.wav", ("s.toml", "--waveform", "tex.wav")), ("tex.wav", ("tex.toml",)),
                               ("tex.wav", ("s.toml", "--waveform", "tex.wav", "--texture", "length", "--texture-mm", "20"))):
                self.kept(file, extension, "plot", *args)
        for file in ("s.svg", "s.toml"):
            self.kept(file, ".svg", "compare", file)

    def test_nor_files_that_the_array_or_the_configuration_names(self):
        self.write("more.toml", '[array]\nfile = "a.toml"\n')
        self.kept("a.toml", ".svg", "plot", "s.toml", "--array", "more.toml")
        self.kept("a.toml", ".svg", "plot", "s.toml", "--config", "more.toml")
        self.write("wave.toml", '[defaults]\nwaveform = "tex.wav"\n')
        self.kept("tex.wav", ".wav", "render", "s.toml", "--config", "wave.toml", force=False)

    def test_sound_does_not_replace_the_recording(self):
        before = (self.dir / "tex.wav").read_bytes()
        for args in (("s.toml", "--waveform", "tex.wav"), ("tex.toml",),
                     ("s.toml", "--waveform", "tex.wav", "--texture", "length", "--texture-mm", "20")):
            self.kept("tex.wav", ".wav", "render", *args, force=False)
        for file in ("s.csv", "s.toml", "p.json", "a.toml", "c.toml"):
            args = {"a.toml": ("s.toml", "--array", "a.toml"), "c.toml": ("s.toml", "--config", "c.toml")}.get(file, (file,))
            self.kept(file, ".wav", "render", *args, force=False)
        self.ok("render", "s.toml", "--waveform", "tex.wav", "-o", "new.wav")
        self.ok("render", "s.toml", "--waveform", "tex.wav", "-o", "new.wav")  # not an input
        self.assertEqual((self.dir / "tex.wav").read_bytes(), before)

    def test_standard_input_and_standard_output_count(self):
        for args, file in ((("render", "-", "-o", "hard.wav"), "s.toml"), (("plot", "-", "-o", "hard.svg", "--force"), "s.toml")):
            os.link(self.dir / file, self.dir / args[3])
            with open(self.dir / file, encoding="utf-8") as f:
                result = self.run_open(args, stdin=f)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual((self.dir / file).read_text(), TOML)
        for args in (("render", "s.toml", "-o", "-"), ("plan", "s.toml"), ("plan", "s.toml", "--format", "json"), ("compare", "s.toml")):
            with open(self.dir / "s.toml", "r+b") as f:
                f.seek(0, os.SEEK_END)
                result = self.run_open(args, stdout=f)
            self.assertEqual(result.returncode, 2, args)
            self.assertEqual((self.dir / "s.toml").read_text(), TOML)

    def run_open(self, args, **more):
        return subprocess.run([TOOL, *args], cwd=self.dir, env=self.env, stderr=subprocess.PIPE, timeout=PATIENCE_S, check=False,
                              **({"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL} | more))

    def test_a_log_is_not_appended_to_an_input(self):
        for file, args in (("s.toml", ("s.toml",)), ("a.toml", ("s.toml", "--array", "a.toml")), ("c.toml", ("s.toml", "--config", "c.toml")),
                           ("tex.wav", ("s.toml", "--waveform", "tex.wav")), ("p.json", ("p.json",))):
            before = (self.dir / file).read_bytes()
            self.refused(2, "play", *args, "-D", "null", "--log", file, says=[file])
            self.assertEqual((self.dir / file).read_bytes(), before)

    def test_a_calibration_replaces_none_of_its_inputs(self):
        calibrate = ("calibrate", "--participant", "P07", "--simulate", "threshold=-40,spread=2", "--tactors", "0")
        for output in ("a.toml", "c.toml"):
            before = (self.dir / output).read_bytes()
            self.refused(2, *calibrate, "--array", "a.toml", "--config", "c.toml", "-o", output, says=[output])
            self.refused(2, *calibrate, "--array", "a.toml", "--config", "c.toml", "-o", "new.toml", "--log", output, says=[output])
            self.assertEqual((self.dir / output).read_bytes(), before)
            self.assertFalse((self.dir / "new.toml").exists())

    def test_analysis_and_report_replace_nothing_of_the_study(self):
        self.simulate()
        table = next((self.dir / "study").glob("sub-01/beh/*.tsv"))
        for command, extension in (("analyze", ".svg"), ("analyze", ".pdf"), ("report", ".md")):
            for file in ("study/participants.tsv", "study/sourcedata/sub-01/session.json", str(table.relative_to(self.dir))):
                if command == "analyze" and file.endswith("participants.tsv"):
                    continue  # not an input of it
                before = contents(self.dir / "study")
                self.kept(file, extension, command, "study")
                self.assertEqual(contents(self.dir / "study"), before)

    def test_an_experiment_does_not_write_over_its_definition(self):
        self.simulate()
        definition = self.dir / "study/participants.json"
        definition.unlink()
        definition.write_text((self.dir / "small.toml").read_text())
        before = definition.read_bytes()
        self.simulate("02", definition="study/participants.json")
        self.assertEqual(definition.read_bytes(), before)


class Foreign(ExperimentTest):
    def test_a_file_of_another_program_is_replaced_only_with_force(self):
        self.simulate()
        png = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIBBBBBI", 13, b"IHDR", 1, 1, 8, 2, 0, 0, 0, 0)
        foreign = {".svg": SVG.encode(), ".png": png, ".pdf": b"%PDF-1.4\n" + b"x" * 40000 + b"\nstartxref\n9\n%%EOF\n",
                   ".md": b"# Methods\n\nA year of writing.\n"}
        for command in (("plot", "park2016-1"), ("compare", "park2016-1"), ("analyze", "study"), ("report", "study")):
            for extension in ((".md",) if command[0] == "report" else (".svg", ".png", ".pdf")):
                with self.subTest(command=command, extension=extension):
                    file = self.write(f"mine{extension}", foreign[extension])
                    self.refused(2, *command, "-o", file.name, says=[file.name, "tactor did not write it", "--force"])
                    self.assertEqual(file.read_bytes(), foreign[extension])
                    self.ok(*command, "-o", file.name, "--force")
                    ours = file.read_bytes()
                    self.assertNotEqual(ours, foreign[extension])
                    self.ok(*command, "-o", file.name)  # its own
                    self.assertEqual(file.read_bytes(), ours)

    def test_a_picture_saved_by_an_editor_belongs_to_the_user(self):
        self.ok("plot", "park2016-1", "-o", "p.svg")
        ours = (self.dir / "p.svg").read_text(encoding="utf-8")
        edited = ours.replace('encoding="UTF-8"?>', 'encoding="UTF-8" standalone="no"?>\n<!-- Created with Inkscape -->', 1)
        self.write("p.svg", edited)
        self.refused(2, "plot", "park2016-1", "-o", "p.svg")
        self.assertEqual((self.dir / "p.svg").read_text(encoding="utf-8"), edited)


if __name__ == "__main__":
    main()
