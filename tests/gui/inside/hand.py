"""Mouse and keyboard: events that Blender takes as if they came from the window. Runs in Blender.

Every method that waits is a generator: `yield from hand.click(x, y)`. Places are window pixels, origin at
the bottom left, as areas and regions have theirs.
"""

import bpy

KEYS = {" ": "SPACE", ".": "PERIOD", "-": "MINUS", ",": "COMMA", "/": "SLASH", "_": "MINUS"}
DIGITS = ["ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE"]
KEYS |= {str(digit): name for digit, name in enumerate(DIGITS)}
WITH_SHIFT = "_"


class Hand:
    """One mouse and keyboard, in the window of that index."""

    def __init__(self, window=0):
        self._index, self.x, self.y = window, 0, 0

    @property
    def window(self):
        """The window; asked for each time, since loading a file replaces it."""
        return bpy.context.window_manager.windows[self._index]

    def send(self, kind, value="NOTHING", **how):
        """Put one event into the window's queue."""
        self.window.event_simulate(type=kind, value=value, x=self.x, y=self.y, **how)

    def tap(self, kind, **how):
        """Press and release, without waiting for Blender to draw."""
        self.send(kind, "PRESS", **how)
        how.pop("unicode", None)
        self.send(kind, "RELEASE", **how)

    def hover(self, x, y):
        """Move there, without waiting."""
        self.x, self.y = round(x), round(y)
        self.send("MOUSEMOVE")

    def move(self, x, y, steps=1):
        """Move there in so many steps; at the end it trembles by a pixel, as a real hand does."""
        start = self.x, self.y
        for i in range(1, steps + 1):
            self.hover(*(a + (b - a) * i / steps for a, b in zip(start, (x, y), strict=True)))
            if i < steps:
                yield
        self.hover(x + 1, y)
        self.hover(x, y)
        yield

    def click(self, x, y, button="LEFTMOUSE", **how):
        """Move there, press and release, faster than Blender draws."""
        self.hover(x + 1, y)
        self.hover(x, y)
        self.tap(button, **how)
        yield

    def swing(self, start, end, button="MIDDLEMOUSE"):
        """Drag faster than Blender draws, as one turns a view."""
        self.hover(*start)
        self.send(button, "PRESS")
        self.hover(*((a + b) / 2 for a, b in zip(start, end, strict=True)))
        self.hover(*end)
        self.send(button, "RELEASE")
        yield

    def drag(self, start, end, steps=8, button="LEFTMOUSE", **how):
        """Press at `start`, release at `end`."""
        yield from self.move(*start)
        self.send(button, "PRESS", **how)
        yield
        yield from self.move(*end, steps=steps)
        self.send(button, "RELEASE", **how)
        yield

    def key(self, kind, **how):
        """Press and release a key."""
        self.tap(kind, **how)
        yield

    def wheel(self, kind, clicks=1):
        """Turn the wheel: WHEELUPMOUSE or WHEELDOWNMOUSE."""
        for _ in range(clicks):
            self.send(kind, "PRESS")
        yield

    def type_text(self, text):
        """Type a text, each key with its character."""
        for letter in text:
            upper = letter.isupper() or letter in WITH_SHIFT
            self.tap(KEYS.get(letter, letter.upper()), unicode=letter, shift=upper)
            yield
