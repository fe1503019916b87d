#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Drawing with the mouse: the drawing is felt meanwhile. Needs Tk (Debian's python3-tk).

    draw.py [DEVICE]               without one: "null", which is not felt
"""
import sys
import tkinter
import warnings

import tactor

PIXELS = 10  # of a millimetre
MARGIN_MM = 8
warnings.filterwarnings("ignore", "the place .* is outside the array")  # end() counts them


class Drawing(tkinter.Canvas):
    """The array of a player; each stroke of the mouse's button is a live stroke."""

    def __init__(self, parent, player):
        places = player.array.positions
        self.origin = places.min(axis=0) - MARGIN_MM
        width, height = (places.max(axis=0) + MARGIN_MM - self.origin) * PIXELS
        super().__init__(parent, width=int(width), height=int(height), background="white")
        for x, y in (places - self.origin) * PIXELS:
            self.create_oval(x - 12, y - 12, x + 12, y + 12, outline="grey")
        self.player, self.finger, self.at = player, None, None
        self.bind("<Button-1>", self.begin)
        self.bind("<B1-Motion>", self.move)
        self.bind("<ButtonRelease-1>", self.end)

    def begin(self, event):
        self.delete("way")
        # Weak, for the first time on a card: then come up in steps of 6 dB.
        self.finger, self.at = self.player.live(level_dbfs=-40), (event.x, event.y)
        self.keep()

    def move(self, event):
        if self.finger is not None:
            self.create_line(*self.at, event.x, event.y, width=3, tags="way")
            self.at = event.x, event.y
            self.to_the_skin()

    def to_the_skin(self):
        x, y = self.at
        self.finger.to(x / PIXELS + self.origin[0], y / PIXELS + self.origin[1])

    def keep(self):
        """Repeats the place: a mouse at rest sends nothing, and a live stroke without points ends after half a second."""
        if self.finger is not None:
            self.to_the_skin()
            self.after(50, self.keep)

    def end(self, _):
        if self.finger is not None:
            self.finger.end()
            self.finger.add_done_callback(lambda t: print(f"{t.report.state}: {t.counts['points']} points, {t.counts['outside']} outside", flush=True))
            self.finger = None


def main():
    device = sys.argv[1] if len(sys.argv) > 1 else "null"
    window = tkinter.Tk()
    window.title("tactor")
    with tactor.Player(device, tactor.Array.preset("palm-3x3")) as player:
        Drawing(window, player).pack()
        window.mainloop()


if __name__ == "__main__":
    main()
