# SPDX-License-Identifier: MIT
"""The errors that a file of tests provokes, each once, as messages/NAME.txt has them and a user reads them.

TACTOR_UPDATE_GOLDEN=1 writes the file anew; the diff then shows what changes for users. <any> in the file stands for what differs
from run to run, or from one version of a library to another, and is kept. So are all messages where a test is skipped: some are
provoked by an ordinary user alone.
"""
import os
import re


class Messages:
    def __init__(self, file, folders):
        """file: the golden file; folders: name shown for each folder of the machine."""
        self.file = file
        self.folders = folders
        self.update = bool(os.environ.get("TACTOR_UPDATE_GOLDEN"))
        lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
        self.held = {line: re.compile(re.escape(line).replace("<any>", ".*")) for line in lines}
        self.seen = set()

    def check(self, stderr, folders):
        """Returns what is wrong with the last line of stderr; "" where the file holds it."""
        message = stderr.rstrip("\n").rsplit("\n", 1)[-1]
        for folder, name in {**folders, **self.folders}.items():
            message = message.replace(str(folder), name)
        message = re.sub(r"\btmp\w{8}\b", "TMP", message)
        held = message if message in self.held else next((line for line, form in self.held.items() if form.fullmatch(message)), None)
        self.seen.add(held or message)
        return "" if held or self.update else f"{self.file.name} does not hold: {message}\n(TACTOR_UPDATE_GOLDEN=1 adds it)"

    def end(self, is_whole):
        """Returns the messages of the file that no test provoked; writes the file where that is asked for. Keeps the messages
        where tests were skipped or failed."""
        kept = self.seen if is_whole else self.seen | self.held.keys()
        if self.update and kept:
            self.file.write_text("".join(f"{line}\n" for line in sorted(kept)), encoding="utf-8")
        return [] if self.update else sorted(self.held.keys() - kept)
