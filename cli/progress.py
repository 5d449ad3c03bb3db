"""Progress on stderr: what is done now, how far it is, and how long it still takes."""

import re
import threading
import time
from contextlib import contextmanager

PATIENCE = 2.0
"""What takes no longer [s] is not shown."""
_TICK = 0.25
_BAR = 24
_SAMPLES = re.compile(r"Sample (\d+)/(\d+)")


class Progress:
    """Steps with their seconds, and one line on a stream (None: silent) that shows the current one."""

    def __init__(self, stream=None):
        self.stream = stream
        self.seconds = {}
        self._shown = 0

    @contextmanager
    def step(self, name, samples=None):
        """Time the block as step `name`; `samples`: of all renders of the step together."""
        start = time.perf_counter()
        self._fraction, self._told = None, start
        self._done, self._last, self._expected = 0, (0, 0), samples
        ended = threading.Event()
        thread = threading.Thread(target=self._show, args=(name, start, ended), daemon=True)
        if self.stream is not None:
            thread.start()
        try:
            yield
        finally:
            ended.set()
            if self.stream is not None:
                thread.join()
            self.clear()
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    def on_render_stats(self, text):
        """Take note of what Cycles says of itself: of each render, the samples that are done."""
        found = _SAMPLES.search(text)
        if not found:
            return
        now = int(found[1]), int(found[2])
        if now[0] < self._last[0]:  # the next view layer, or the next render
            self._done += self._last[1]
        self._last = now
        done, expected = (self._done + now[0], self._expected) if self._expected else now
        self._fraction, self._told = min(done / expected, 1.0), time.perf_counter()

    def clear(self):
        """Remove the line."""
        if self._shown:
            self.stream.write("\r" + " " * self._shown + "\r")
            self.stream.flush()
            self._shown = 0

    def _show(self, name, start, ended):
        while not ended.wait(_TICK):
            elapsed = time.perf_counter() - start
            if elapsed >= PATIENCE:
                text = line(name, elapsed, self._fraction, self._told - start)
                self.stream.write("\r" + text.ljust(self._shown))
                self.stream.flush()
                self._shown = len(text)


def line(name, elapsed, fraction=None, elapsed_then=0.0):
    """One line of progress after `elapsed` seconds; the fraction was true when `elapsed_then` had passed.

    >>> line("render", 32.0, 0.25, 32.0)
    'render  ██████──────────────────   25 %  1:36 left'
    >>> line("image", 61.4)
    'image  1:01'
    """
    if not fraction:
        return f"{name}  {_clock(elapsed)}"
    bar = "█" * int(_BAR * fraction)
    left = max(elapsed_then / fraction - elapsed, 0.0)
    return f"{name}  {bar.ljust(_BAR, '─')}  {fraction:4.0%}".replace("%", " %") + f"  {_clock(left)} left"


def _clock(seconds):
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"
