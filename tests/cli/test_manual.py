# SPDX-License-Identifier: MIT
"""The options of --help and those of tactor(1) are the same, command by command.

An option in the section OPTIONS belongs to the commands that its text names in the form ".Cm plot , compare :", or that
its subsection names in "All of these are of"; where none is named, to every command that takes a STROKE.
"""
import re
import subprocess

from harness import ROOT, ToolTest, main

MAN = (ROOT / "man/tactor.1").read_text(encoding="utf-8")


def section(title):
    return re.search(rf'^\.Sh {title}\n(.*?)(?=^\.Sh )', MAN, re.M | re.S)[1]


def command_names(text, commands):
    """Returns the commands in all lines such as ".Cm plan , compare :" of a text."""
    lists = re.findall(r"^\.Cm ((?:\w+ , )*\w+) :", text, re.M)
    return {name for names in lists for name in names.split(" , ")} & set(commands)


def man_options(commands):
    """Maps an option to the commands that take it; empty: all that take a STROKE."""
    options = {}
    for subsection in re.split(r"^\.Ss ", section("OPTIONS"), flags=re.M):
        intro, *entries = re.split(r"^\.It ", subsection, flags=re.M)
        of_all = re.search(r"^All of these are of\n\.Cm ((?:\w+ , )*\w+)", intro, re.M)
        for entry in entries:
            head, _, body = entry.partition("\n")
            takers = command_names(body, commands) | (set(of_all[1].split(" , ")) if of_all else set())
            for name in re.findall(r"(?:Fl|,) (-[\w-]+|[a-zA-Z](?= ))", head):
                options["-" + name] = options.get("-" + name, set()) | takers
    return options


class Manual(ToolTest):
    def read_help(self, *command):
        text = self.ok(*command, "--help-all" if command else "--help").stdout
        return text, {name for names in re.findall(r"^  (-\S+)", text, re.M) for name in names.split(",")}

    def commands(self):
        text, _ = self.read_help()
        found = re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M)
        self.assertGreaterEqual(len(found), 5)
        return found

    def test_each_command_has_its_options_in_the_manual_and_no_others(self):
        commands = self.commands()
        manual = man_options(commands)
        self.assertGreater(len(manual), 35)
        for command in commands:
            text, helped = self.read_help(command)
            takes_strokes = re.search(r"^  STROKE", text, re.M) is not None
            named = {o for o, takers in manual.items() if command in takers}
            common = {o for o, takers in manual.items() if not takers}
            self.assertEqual(helped - named - common, set(), f"{command} --help has what the manual does not say")
            self.assertEqual((named | (common if takes_strokes else set())) - helped - {"--version"}, set(),
                             f"the manual says of {command} what --help does not")

    def test_commands_with_a_separate_page_have_their_options_there(self):
        for command in ("calibrate", "experiment", "analyze", "report"):
            page = (ROOT / f"man/tactor-{command}.1").read_text(encoding="utf-8")
            described = {"-" + name for head in re.findall(r"^\.It (.*)", page, re.M)
                         for name in re.findall(r"(?:Fl|,) (-[\w-]+|[a-zA-Z](?= ))", head)}
            self.assertEqual(self.read_help(command)[1] - {"-h", "--help", "--help-all"}, described, command)

    def test_a_plan_is_a_stroke_of_the_commands_that_take_one(self):
        self.write("plan.json", self.ok("plan", "park2016-1", "--format", "json").stdout)
        for command, more in (("plan", ()), ("render", ("-o", "x.wav")), ("play", ("-D", "null")), ("plot", ("-o", "x.svg")),
                              ("compare", ())):
            taken = self.run_tool(command, "plan.json", *more).returncode == 0
            self.assertEqual(".json: a plan" in " ".join(self.read_help(command)[0].split()), taken, command)

    def test_options_of_all_commands_are_in_the_manual(self):
        _, helped = self.read_help()
        self.assertEqual(helped, {"-h", "--help", "--help-all", "--version"})

    def test_each_command_is_in_synopsis_and_description(self):
        commands = self.commands()
        self.assertEqual(set(re.findall(r"^\.Nm\n\.Cm (\w+)", section("SYNOPSIS"), re.M)), set(commands))
        described = re.search(r"^\.Ss Commands\n(.*?)^\.Ss ", MAN, re.M | re.S)[1]
        self.assertEqual(set(re.findall(r"^\.It Cm (\w+)", described, re.M)), set(commands))

    def test_each_command_ends_its_help_with_an_example_that_parses(self):
        for command in self.commands():
            text, _ = self.read_help(command)
            self.assertRegex(text, rf"(?m)^Examples:\n  tactor {command}", command)

    def test_pages_read_as_intended(self):
        for page in sorted((ROOT / "man").glob("*.[1-8]")):
            with self.subTest(page=page.name):
                # .Dq takes the whole line, "No" or not: .Do ... Dc ends before.
                self.assertEqual(re.findall(r"^.*\b[DS]q \S+ No .*$", page.read_text(encoding="utf-8"), re.M), [])
                text = subprocess.run(["man", "-E", "UTF-8", "-l", "-Tutf8", page], capture_output=True, encoding="utf-8", check=True,
                                      env=self.env | {"MANWIDTH": "80"}).stdout
                self.assertGreater(len(text), 1000)
                self.assertEqual(re.findall(r"^.*[\w”] +[,;:)](?:\s.*)?$", text, re.M), [])


def parse_number(text):
    base, _, power = text.partition("^")
    return float(base) ** float(power or 1)


class Ranges(ToolTest):
    RANGE = r"(-?[\d.e+]+) to ([\d.e+^]+)"

    def range_in(self, text):
        return tuple(parse_number(n) for n in re.search(self.RANGE, text).groups())

    def test_an_option_its_key_and_the_manual_agree(self):
        page = (ROOT / "man/tactor.toml.5").read_text(encoding="utf-8")
        table = re.search(r"^\[defaults\]\tunit\tvalues\n(.*?)^\.TE", page, re.M | re.S)[1]
        keys = [(key, said) for key, said in re.findall(r"^([\w-]+)\t.*\tT\{\n(.*)\nT\}$", table, re.M) if re.match(self.RANGE, said)]
        self.assertGreaterEqual(len(keys), 17)
        for key, said in keys:
            manual = self.range_in(said)
            file = self.refused(2, "plan", "park2016-1", "--config", self.write("d.toml", f"[defaults]\n{key} = nan\n"),
                                says=["d.toml:2:"]).stderr
            self.assertEqual(self.range_in(file.partition("(")[2]), manual, key)
            option = self.refused(2, "play", "park2016-1", "-D", "null", f"--{key}", "nan", says=[f"--{key}: "]).stderr
            self.assertEqual(self.range_in(option.partition("(")[2]), manual, key)


if __name__ == "__main__":
    main()
