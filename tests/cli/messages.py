# SPDX-License-Identifier: MIT
"""The errors that a file of tests provokes, held to messages/NAME.txt as a user reads them.

TACTOR_UPDATE_GOLDEN=1 writes the file anew; the diff then shows what changes for users. <any> in the file stands for what differs
from run to run, or from one version of a library to another, and is kept. So are the messages of tests that are skipped, such as
those that an ordinary user alone can provoke.
"""
import os
import re

LONGEST = 160  # characters of a command


class Messages:
    def __init__(self, file, folders):
        """file: the golden file; folders: name shown for each folder of the machine."""
        self.file = file
        self.folders = folders
        self.update = bool(os.environ.get("TACTOR_UPDATE_GOLDEN"))
        self.held = {}  # test -> [(command, message)]
        self.seen = {}
        test = None
        for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else []:
            if line.startswith("## "):
                test = self.held.setdefault(line[3:], [])
            elif line.startswith("$ "):
                test.append([line[2:], ""])
            elif line:
                test[-1][1] = line

    def plain(self, text, more):
        for folder, name in {**more, **self.folders}.items():
            text = text.replace(str(folder), name)
        return re.sub(r"\btmp\w{8}\b", "TMP", text).replace("\n", "\\n")

    def check(self, test, args, stderr, folders):
        """Returns what is wrong with the last line of stderr; "" where it is as held."""
        command = " ".join(["tactor", *(self.plain(str(a), folders) or '""' for a in args)])
        if len(command) > LONGEST:
            command = command[:LONGEST] + "..."
        message = self.plain(stderr.rstrip("\n").rsplit("\n", 1)[-1], folders)
        seen = self.seen.setdefault(test, [])
        held = self.held.get(test, [])
        held_message = held[len(seen)][1] if len(seen) < len(held) else None
        fits = held_message is not None and re.fullmatch(re.escape(held_message).replace("<any>", ".*"), message) is not None
        seen.append([command, held_message if fits else message])
        if fits or self.update:
            return ""
        return f"{command}\nsays: {message}\nheld: {held_message}\n(TACTOR_UPDATE_GOLDEN=1 accepts it into {self.file.name})"

    def write(self, skipped):
        """Writes the golden file where that is asked for; keeps the messages of the tests that were skipped."""
        if self.update and self.seen:
            self.seen |= {test: held for test, held in self.held.items() if test in skipped}
            self.file.parent.mkdir(exist_ok=True)
            self.file.write_text("\n".join(f"## {test}\n" + "".join(f"$ {command}\n{message}\n" for command, message in all_of)
                                           for test, all_of in sorted(self.seen.items())), encoding="utf-8")
