# SPDX-License-Identifier: MIT
"""Array files by others: they name the device, and none of their texts writes a file or runs a command."""
import os

from harness import ALSA_CONFIG, GRID, ToolTest, main

MORE_PCMS = """
pcm.file {
    @args [ FILE FORMAT ]
    @args.FILE { type string }
    @args.FORMAT { type string default raw }
    type file
    slave.pcm { type null }
    file $FILE
    format $FORMAT
}
pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }
pcm.recorder { type file slave.pcm { type null } file "kept" format raw }
pcm.hidden { type plug slave.pcm "recorder" }
pcm.desk { type plug slave.pcm "null" }
"""
COMMAND = "file:'|touch ran; cat >/dev/null',raw"
# Each would write, run or define something, in another way.
HOSTILE = (COMMAND, "file:kept,raw", "file:FILE=kept", "raw:kept", "recorder", "hidden", "plug:recorder", "plug:'recorder'",
           "{ type file slave.pcm null file kept format raw }", "plug:{ type file slave.pcm null file kept format raw }",
           "plug:\"file:'kept',raw\"", "plug:'file:\\'kept\\',raw'", "null\nfile:kept", "@x", "kept/../kept", " null")


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


class SharedFiles(ToolTest):
    STROKE = ("--path", "M 0 0 L 20 0", "--duration", "0.08")

    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + MORE_PCMS)
        self.write("kept", "precious")

    def array(self, pcm, name="a.toml"):
        return self.write(name, GRID.replace('"null"', quoted(pcm)))

    def untouched(self):
        self.assertEqual((self.dir / "kept").read_text(), "precious")
        self.assertFalse((self.dir / "ran").exists())

    def test_an_array_file_cannot_write_or_run_anything(self):
        for pcm in HOSTILE:
            self.array(pcm)
            for command in (("play", *self.STROKE), ("check",), ("check", "--walk", "--auto"), ("devices",)):
                with self.subTest(pcm=pcm, command=command):
                    # The line and column of pcm, the fault, and the hint.
                    self.refused(2, *command, "--array", "a.toml")
                    self.untouched()

    def test_nor_can_an_included_file(self):
        self.array(COMMAND, "others/a.toml")
        self.write("mine.toml", '[array]\nfile = "others/a.toml"\n')
        self.write("between.toml", '[array]\nfile = "mine.toml"\n')
        for how in (("--array", "mine.toml"), ("--array", "between.toml"), ("--config", "mine.toml"), ("--config", "between.toml")):
            with self.subTest(how=how):
                self.refused(2, "play", *self.STROKE, *how)
                self.refused(2, "check", *how)
        self.untouched()

    def test_check_reports_it_for_the_device_and_hides_nothing_else(self):
        self.array(COMMAND)
        out = self.refused(2, "check", "--array", "a.toml").stdout
        self.assertRegex(out, r"(?m)^error    device +a\.toml:11:7: PCM")
        self.assertRegex(out, r"(?m)^(ok|warning)  +real time ")
        self.untouched()

    def test_commands_without_a_device_still_work(self):
        self.array(COMMAND)
        self.plan(*self.STROKE, "--array", "a.toml")
        self.ok("render", *self.STROKE, "--array", "a.toml", "-o", "a.wav")
        self.ok("play", *self.STROKE, "--array", "a.toml", "-D", "null")
        self.ok("check", "--array", "a.toml", "-D", "null")
        self.untouched()

    def test_devices_by_their_names_are_accepted(self):
        for pcm in ("null", "default", "desk", "plug:null", "plug:'null'", "plug:SLAVE=null"):
            with self.subTest(pcm=pcm):
                self.array(pcm)
                self.ok("play", *self.STROKE, "--array", "a.toml")
                self.ok("check", "--array", "a.toml")
        self.array("hw:CARD=Nowhere,DEV=0")
        self.refused(3, "play", *self.STROKE, "--array", "a.toml")

    def test_the_command_line_and_the_user_s_configuration_may_name_more(self):
        self.write("mine.toml", GRID.replace('"null"', quoted(f"file:'{self.dir}/out.raw',raw")))
        self.ok("play", *self.STROKE, "--config", "mine.toml")
        self.assertTrue((self.dir / "out.raw").stat().st_size)
        self.ok("play", *self.STROKE, "-D", f"file:'|cat >{self.dir}/piped',raw")
        self.assertTrue((self.dir / "piped").stat().st_size)
        # The file's own name wins over that of an included file.
        self.array(COMMAND, "others/a.toml")
        self.write("mine.toml", '[array]\nfile = "others/a.toml"\n[output]\npcm = "recorder"\n')
        self.ok("play", *self.STROKE, "--config", "mine.toml")
        self.assertNotEqual((self.dir / "kept").read_bytes(), b"precious")

    def test_check_and_devices_never_open_files_that_they_would_empty(self):
        for pcm in ("file:FILE=kept", "recorder", "hidden", "plug:recorder", COMMAND):
            with self.subTest(pcm=pcm):
                r = self.ok("check", "-D", pcm)
                self.assertRegex(r.stdout, r"(?m)^warning  device .*not opened")
                self.assertIn("not tried", " ".join(self.ok("devices", "-D", pcm).stdout.split()).lower())
                self.untouched()
        self.ok("devices")
        self.untouched()

    def test_an_included_file_must_be_a_file(self):
        os.mkfifo(self.dir / "pipe.toml")
        self.write("mine.toml", '[array]\nfile = "pipe.toml"\n')
        self.refused(2, "plan", *self.STROKE, "--array", "mine.toml")
        self.write("mine.toml", '[array]\nfile = "/dev/zero"\n')
        self.refused(2, "plan", *self.STROKE, "--array", "mine.toml")

    def test_a_file_that_is_no_gpio_chip_is_not_opened(self):
        os.mkfifo(self.dir / "pipe")
        for table in ("[amplifier]\nline =", "[sync]\nout ="):
            for chip in (f"{self.dir}/pipe", f"{self.dir}/kept", "/dev/null"):
                with self.subTest(table=table, chip=chip):
                    self.write("a.toml", GRID + f'{table} {{ chip = "{chip}", offset = 1 }}\n')
                    self.refused(3, "check", "--array", "a.toml")
                    self.refused(3, "play", *self.STROKE, "--array", "a.toml")
        self.untouched()


if __name__ == "__main__":
    main()
