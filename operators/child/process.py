"""The parent's side of a child process that does long work in a folder of its own. No Blender data here."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import tempfile
import threading
import time
from pathlib import Path

from .job import OUTPUT, PROGRESS, RESULT

GRACE = 1.0
"""A child that is to end has so long [s] to clean up behind itself."""

WINDOWS_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0) | getattr(
    subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0
)


class ChildProcess:
    """A process that works in a temporary folder until its result lies there."""

    def __init__(self, folder: tempfile.TemporaryDirectory, command: list[str]):
        """Start the command. Raises OSError where it cannot be started."""
        self.folder = folder
        self.path = Path(folder.name)
        self.step, self.samples = "starting", None
        self._start = time.monotonic()
        temporary = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), folder.name)
        with (self.path / OUTPUT).open("wb") as output:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,  # held open, never written: the child ends when it closes
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **temporary},
                start_new_session=True,
                creationflags=WINDOWS_FLAGS,
            )
        (self.path / PROGRESS).touch()
        self._progress = (self.path / PROGRESS).open(encoding="utf-8")
        self._unfinished_line = ""

    @property
    def seconds(self) -> float:
        """Since its start."""
        return time.monotonic() - self._start

    def read_progress(self):
        """Bring `step` and `samples` (done, of all; or None) up to date, without waiting."""
        *lines, self._unfinished_line = (self._unfinished_line + self._progress.read()).split("\n")
        for line in lines:
            told = json.loads(line)
            self.step, self.samples = told.get("step", self.step), told.get("samples")

    def is_done(self) -> bool:
        """Whether there is a result, or will be none."""
        return (self.path / RESULT).exists() or self.process.poll() is not None

    def value(self):
        """The result. Raises ValueError with what the child refused, or how it ended without a word."""
        try:
            result = pickle.loads((self.path / RESULT).read_bytes())
        except FileNotFoundError:
            said = (self.path / OUTPUT).read_text(encoding="utf-8", errors="replace").split("\n")
            last = next((line.strip() for line in reversed(said) if line.strip()), "it said nothing")
            status = self.process.poll()
            raise ValueError(f"the Blender that did it ended with status {status}: {last}") from None
        if result.refusal:
            raise ValueError(result.refusal)
        return result.value

    def stop(self) -> threading.Thread:
        """End the process, with all that it started, and remove its folder; a thread sees to it.

        Python waits for that thread before it ends itself.
        """
        self.process.stdin.close()
        self._progress.close()
        thread = threading.Thread(target=self._end, name="end of a child")
        thread.start()
        return thread

    def _end(self):
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._kill()
        self.folder.cleanup()

    def _kill(self):
        if hasattr(os, "killpg"):
            os.killpg(self.process.pid, signal.SIGKILL)  # it leads a session, and so a group, of its own
        else:
            self.process.kill()
        self.process.wait()
