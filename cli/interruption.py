"""Ctrl-C: the run ends at once, also from within a render, and leaves nothing behind.

Python acts on a signal between two of its own instructions; a render is one call that takes minutes. So the
signal also wakes a thread, which lets Python unwind if it can, and otherwise cleans up and ends the process.
"""

import os
import shutil
import signal
import socket
import sys
import tempfile
import threading
from contextlib import contextmanager

from ..ibl_toolkit.images.atomic import discard_unfinished

STATUS = 130
LINE = "interrupted"
GRACE = 1.0
"""Time [s] that Python has to unwind where no render is under way."""


@contextmanager
def watched(label, progress):
    """While the block runs, Ctrl-C raises KeyboardInterrupt in it, or ends the process with STATUS.

    Temporary files of the block, Blender's included, lie in one folder that goes with it. In a thread, where
    signals don't arrive, only that.
    """
    before = tempfile.tempdir
    with tempfile.TemporaryDirectory(prefix="panorama_") as scratch:
        tempfile.tempdir = scratch
        try:
            if threading.current_thread() is threading.main_thread():
                with _watcher(label, progress, scratch):
                    yield
            else:
                yield
        finally:
            tempfile.tempdir = before


@contextmanager
def _watcher(label, progress, scratch):
    wakes, wakened = socket.socketpair()
    wakened.setblocking(False)
    ended = threading.Event()

    def raise_if_python_can(_signal, _frame):
        if not progress.rendering:  # else it would be raised in a handler, where Blender only prints it
            raise KeyboardInterrupt

    def watch():
        if wakes.recv(1) != bytes([signal.SIGINT]):
            return
        if progress.rendering or not ended.wait(GRACE):
            _leave(label, progress, scratch)

    previous = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, raise_if_python_can)
    previous_fd = signal.set_wakeup_fd(wakened.fileno(), warn_on_full_buffer=False)
    thread = threading.Thread(target=watch, name="Ctrl-C", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(previous_fd)
        signal.signal(signal.SIGINT, signal.SIG_DFL if previous is None else previous)
        wakened.close()
        thread.join()
        wakes.close()


def _leave(label, progress, scratch):
    """End the process from outside of Blender, which would go on to the end of its render."""
    progress.clear()
    discard_unfinished()
    shutil.rmtree(scratch, ignore_errors=True)
    if progress.blender_folder:
        shutil.rmtree(progress.blender_folder, ignore_errors=True)
    print(f"{label}: {LINE}", file=sys.stderr, flush=True)
    os._exit(STATUS)
