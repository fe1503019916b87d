# SPDX-License-Identifier: MIT
"""Each command has a page with the options of its --help, and with examples.

The section OPTIONS lists options of the command as items; those that other commands share stand under "Common options".
"""
import re
import subprocess

from harness import ROOT, ToolTest, main

SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "FILES", "EXIT STATUS", "EXAMPLES", "SEE ALSO"]


def read_page(name):
    return (ROOT / "man" / name).read_text(encoding="utf-8")


def find_page(command):
    return read_page(f"tactor-{command}.1")


def section(page, title):
    return re.search(rf"^\.Sh {title}\n(.*?)(?=^\.Sh |\Z)", page, re.M | re.S)[1]


def options_in(text):
    common = "".join(re.findall(r'^\.\\" Common options.*\n((?:.*\n)*?)\.El', text, re.M))
    heads = re.findall(r"^\.It .*", text, re.M) + re.findall(r"^\.Fl .*", common, re.M)
    return {"-" + name for head in heads for name in re.findall(r"(?:Fl|,) (-[\w-]+|[a-zA-Z](?= |$))", head)}


def man_options(command):
    return options_in(section(find_page(command), "OPTIONS"))


class Manual(ToolTest):
    def read_help(self, *command):
        text = self.ok(*command, "--help-all" if command else "--help").stdout
        return text, {name for names in re.findall(r"^  (-\S+)", text, re.M) for name in names.split(",")}

    def commands(self):
        text, _ = self.read_help()
        found = re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M)
        self.assertGreaterEqual(len(found), 5)
        return found

    def test_each_command_has_its_options_in_its_page_and_no_others(self):
        for command in self.commands():
            self.assertEqual(man_options(command), self.read_help(command)[1] - {"-h", "--help", "--help-all"}, command)

    def test_the_page_of_a_command_has_all_sections_and_three_examples(self):
        for command in self.commands():
            page = find_page(command)
            with self.subTest(command):
                self.assertEqual([title for title in re.findall(r"^\.Sh (.*)", page, re.M) if title in SECTIONS], SECTIONS)
                self.assertIn(f".Nm tactor-{command}", section(page, "NAME"))
                self.assertIn(f".Nm tactor\n.Cm {command}\n", section(page, "SYNOPSIS"))
                self.assertGreaterEqual(len(re.findall(r"^\.Dl .*\btactor ", section(page, "EXAMPLES"), re.M)), 3)

    def test_a_plan_is_a_stroke_of_the_commands_that_take_one(self):
        self.write("plan.json", self.ok("plan", "park2016-1", "--format", "json").stdout)
        for command, more in (("plan", ()), ("render", ("-o", "x.wav")), ("play", ("-D", "null")), ("plot", ("-o", "x.svg")),
                              ("compare", ())):
            taken = self.run_tool(command, "plan.json", *more).returncode == 0
            self.assertEqual(".json: a plan" in " ".join(self.read_help(command)[0].split()), taken, command)

    def test_the_overview_has_the_options_of_the_tool_and_each_command(self):
        page = read_page("tactor.1")
        self.assertEqual(options_in(section(page, "OPTIONS")), self.read_help()[1])
        listed = re.findall(r"^\.It Cm (\w+)\n.*\n\.Xr tactor-(\w+) 1", section(page, "COMMANDS"), re.M)
        self.assertEqual(sorted(listed), sorted((command, command) for command in self.commands()))

    def test_each_command_ends_its_help_with_an_example_that_parses(self):
        for command in self.commands():
            text, _ = self.read_help(command)
            self.assertRegex(text, rf"(?m)^Examples:\n  tactor {command}", command)

    def test_pages_read_as_intended(self):
        for page in sorted((ROOT / "man").glob("*.[1-8]")):
            with self.subTest(page=page.name):
                # .Dq takes the whole line, also what follows "No" or another .Dq: .Do ... Dc ends before.
                self.assertEqual(re.findall(r"^\..*\b(?:[DQS]q|Ql) .* (?:No|[DQS]q|Ql) .*$", page.read_text(encoding="utf-8"), re.M), [])
                text = subprocess.run(["man", "-E", "UTF-8", "-l", "-Tutf8", page], capture_output=True, encoding="utf-8", check=True,
                                      env=self.env | {"MANWIDTH": "80"}).stdout
                self.assertGreater(len(text), 1000)
                self.assertEqual(re.findall(r"^.*[\w”] +[,;:)](?:\s.*)?$", text, re.M), [])
                self.assertEqual(re.findall("“[^”]*“|”[^“]*”", text), [])


def parse_number(text):
    base, _, power = text.partition("^")
    return float(base) ** float(power or 1)


class Ranges(ToolTest):
    RANGE = r"(-?[\d.e+]+) to ([\d.e+^]+)"

    def range_in(self, text):
        return tuple(parse_number(n) for n in re.search(self.RANGE, text).groups())

    def test_an_option_its_key_and_the_manual_agree(self):
        page = read_page("tactor.toml.5")
        table = re.search(r"^\[defaults\]\tunit\tvalues\n(.*?)^\.TE", page, re.M | re.S)[1]
        keys = [(key, said) for key, said in re.findall(r"^([\w-]+)\t.*\tT\{\n(.*)\nT\}$", table, re.M) if re.match(self.RANGE, said)]
        self.assertGreaterEqual(len(keys), 17)
        for key, said in keys:
            manual = self.range_in(said)
            file = self.refused(2, "plan", "park2016-1", "--config", self.write("d.toml", f"[defaults]\n{key} = nan\n")).stderr
            self.assertEqual(self.range_in(file.partition("(")[2]), manual, key)
            option = self.refused(2, "play", "park2016-1", "-D", "null", f"--{key}", "nan", says=[f"--{key}: "]).stderr
            self.assertEqual(self.range_in(option.partition("(")[2]), manual, key)


if __name__ == "__main__":
    main()
