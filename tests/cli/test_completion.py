# SPDX-License-Identifier: MIT
"""Completion: the tool's candidates, and bash, zsh and fish as people type in them."""
import os
import re
import shutil
import subprocess

from harness import ROOT, TOOL, ToolTest, main
from terminal import Terminal

SCRIPTS = ROOT / "src/cli/completion"
# Prints each word in another form than it was typed, since the terminal shows the typed line too.
SHOW = r"printf '\74%s\76' "


class Completion(ToolTest):
    def setUp(self):
        super().setUp()
        (self.dir / "bin").mkdir()
        (self.dir / "bin/tactor").symlink_to(TOOL)
        for name in ("forearm.toml", "formant.wav", "trace.csv", "folder/x.toml"):
            self.write(name, "")
        self.env |= {"PATH": f"{self.dir}/bin:{os.environ['PATH']}", "HOME": str(self.dir), "PS1": "READY> ",
                     "INPUTRC": "/dev/null", "XDG_DATA_HOME": str(self.dir / "data"), "ZDOTDIR": str(self.dir)}

    def offered(self, *words):
        lines = self.ok("__complete", *words).stdout.splitlines()
        return [line.split("\t")[0] for line in lines]

    def needs(self, shell):
        if shutil.which(shell) is None:
            self.skipTest(f"{shell} is not here")

    # Candidates of the tool.

    def test_commands_and_options_are_those_of_help(self):
        def of_help(*command):
            text = self.ok(*command, "--help-all" if command else "--help").stdout
            options = {n for names in re.findall(r"^  (-\S+)", text, re.M) for n in names.split(",")}
            return options, set(re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M))

        options, commands = of_help()
        self.assertEqual(set(self.offered("")), commands)
        self.assertEqual(set(self.offered("-")), options)
        self.assertGreaterEqual(len(commands), 5)
        for command in commands:
            self.assertEqual(set(self.offered(command, "-")), of_help(command)[0], command)

    def test_each_offered_value_is_accepted(self):
        for option in ("--phantom", "--faces", "--algorithm", "--overlap", "--timing", "--outside", "--array", "--phase",
                       "--sample-format", "--format"):
            values = [v for v in self.offered("plan", option, "") if not v.startswith(":")]
            self.assertGreaterEqual(len(values), 2, option)
            for value in values:
                self.ok("plan", "--path", "M 0 0 L 20 0", option, value)
                self.assertEqual(self.offered("plan", f"{option}={value[:-1]}").count(f"{option}={value}"), 1)

    def test_strokes_files_and_devices_are_offered(self):
        for line, offered in (("play park2016-3", ["park2016-3", ":files"]), ("plan --array x", [":files"]), ("plan --config=", [":files"]),
                              ("render -o ", [":files"]), ("plot --output ", [":files"]), ("compare --phantoms l", ["linear", "log"]),
                              ("plan --soa ", []), ("status --socket ", [":files"]), ("serve --tcp ", []), ("analyze ", [":files"]), ("report ", [":files"]),
                              ("report -o ", [":files"]), ("experiment ", ["park2016", ":files"]), ("experiment park2016 -o ", [":files"]),
                              ("experiment --display ", ["page", "terminal"]), ("analyze --format t", ["text", "tables", "tsv"]),
                              ("analyze --participants ", []), ("nonsense ", [])):
            self.assertEqual(self.offered(*line.split(" ")), offered, line)
        self.assertIn("null", self.offered("play", "-D", ""))
        for command in ("experiment", "calibrate"):
            self.assertIn("--verbose", self.offered(command, "--verb"))
        self.assertEqual(self.ok("__complete").stdout, "")

    # The shells' part: the typed text, and the words that the line has after Tab.

    TYPED = [
        ("tactor comp", ["tactor", "compare"]),
        ("tactor play park2016-3 --phantom ba", ["tactor", "play", "park2016-3", "--phantom", "barycentric"]),
        ("tactor plan --array=palm-3", ["tactor", "plan", "--array=palm-3x3"]),
        ("tactor plan --array fo", ["tactor", "plan", "--array", "folder/"]),
        ("tactor analyze fo", ["tactor", "analyze", "folder/"]),
        ("tactor plan --array forea", ["tactor", "plan", "--array", "forearm.toml"]),
        ("tactor plan --array=forea", ["tactor", "plan", "--array=forearm.toml"]),
        ("tactor plan tr", ["tactor", "plan", "trace.csv"]),
        ("tactor render --path 'M 0 0 L 40 0' --level", ["tactor", "render", "--path", "M 0 0 L 40 0", "--level-dbfs"]),
        ("tactor compare --phantoms gau", ["tactor", "compare", "--phantoms", "gaussian"]),
        ("fake play -D hw:CARD=T", ["fake", "play", "-D", "hw:CARD=Tactor"]),
        ("fake play -D ", ["fake", "play", "-D", "hw:CARD="]),
        ("fake play -D hw:", ["fake", "play", "-D", "hw:CARD="]),
        ("fake play --device=hw:CARD=T", ["fake", "play", "--device=hw:CARD=Tactor"]),
    ]

    def type_into(self, shell, *options, setup):
        fake = self.write("bin/fake", '#!/bin/sh\nfor last; do :; done\n'
                                      'case $last in --*=*) o=${last%%=*}=;; esac\n'
                                      'for n in Tactor Other; do\n'
                                      'case ${o}hw:CARD=$n in "$last"*) echo "${o}hw:CARD=$n" ;; esac; done\n')
        fake.chmod(0o755)
        t = Terminal(self, options, shell, term="dumb", has_console=False)
        t.until("READY> ")
        t.key(f"{setup}; echo DO''NE\n")
        t.until("DONE")
        for typed, words in self.TYPED:
            if words[-1] == "folder/":
                continue  # ambiguous: nothing is completed
            # Tab; a last word at the end of the line; and the code that shows the words at its beginning.
            t.key(f"{typed}\t\005 END\001{SHOW}\n")
            seen = t.until("<END>").string
            self.assertEqual(re.findall("<(.*?)>", seen)[:-1], words, typed)

    def test_bash_completes(self):
        self.needs("bash")
        self.type_into("bash", "--norc", "--noprofile", "-i",
                       setup=f"bind 'set bell-style none'; source {SCRIPTS}/tactor.bash; complete -F _tactor fake")

    def test_zsh_completes(self):
        self.needs("zsh")
        self.type_into("zsh", "-f", "-i", setup=f"fpath=({SCRIPTS} $fpath); setopt nobeep; bindkey -e; PROMPT='READY> '; "
                       "autoload -U compinit; compinit -u; compdef _tactor fake; unsetopt automenu")

    def test_fish_completes(self):
        self.needs("fish")
        for typed, words in self.TYPED:
            if words[0] == "fake":
                continue
            r = subprocess.run(["fish", "--no-config", "-c", f"source {SCRIPTS}/tactor.fish; complete -C \"{typed}\""],
                               env=self.env, cwd=self.dir, capture_output=True, text=True, check=False)
            self.assertEqual(r.stderr, "")
            self.assertEqual(r.stdout.split("\n")[0].split("\t")[0], words[-1], typed)
            if words[-1] == "compare":
                self.assertEqual(r.stdout.count("\t"), 1)  # its explanation


if __name__ == "__main__":
    main()
