"""Ctrl-C: the run ends at once, also from within a render, and leaves nothing behind.

Python acts on a signal between two of its own instructions, but a render is one call that takes minutes;
and an exception in the midst of Blender's own Python leaves it broken. So the signal wakes a thread instead,
which cleans up and ends the process.
"""

import os
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress

STATUS = 130


class Watch:
    """What is done as the process ends: one line with `label`, after `clear` has made room for it."""

    def __init__(self, label):
        self.label = label
        self.clear = lambda: None
        self.leaving = threading.Event()


@contextmanager
def watched(label):
    """While the block runs, Ctrl-C ends the process with STATUS; gives a Watch.

    Temporary files of the block lie in one folder that goes with it. In another thread than the main one,
    where signals don't arrive, only that.
    """
    before = tempfile.tempdir
    with tempfile.TemporaryDirectory(prefix="panorama_") as scratch:
        tempfile.tempdir = scratch
        watch = Watch(label)
        try:
            if threading.current_thread() is threading.main_thread():
                with _waking(lambda: _leave(watch, scratch)):
                    yield watch
            else:
                yield watch
        finally:
            if watch.leaving.is_set():
                threading.Event().wait()  # what failed just now is the doing of the thread that ends us
            tempfile.tempdir = before


@contextmanager
def _waking(leave):
    """While the block runs, SIGINT makes another thread call `leave`, whatever the main one is doing."""
    receiver, sender = socket.socketpair()
    sender.setblocking(False)

    def wait():
        while received := receiver.recv(1):  # the number of a signal; nothing when the sender is closed
            if received[0] == signal.SIGINT:
                leave()

    previous = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, lambda *_: None)
    previous_fd = signal.set_wakeup_fd(sender.fileno(), warn_on_full_buffer=False)
    thread = threading.Thread(target=wait, name="Ctrl-C", daemon=True)
    thread.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(previous_fd)
        signal.signal(signal.SIGINT, signal.SIG_DFL if previous is None else previous)
        sender.close()
        thread.join()
        receiver.close()


def _leave(watch, scratch):
    watch.leaving.set()
    try:
        watch.clear()
        print(f"{watch.label}: interrupted", file=sys.stderr, flush=True)
        _discard(scratch)
    finally:
        os._exit(STATUS)


def _discard(scratch):
    # What is not imported has made nothing; to import it here could wait for an import of the main thread.
    atomic = sys.modules.get(f"{__package__.rpartition('.')[0]}.ibl_toolkit.images.atomic")
    if hasattr(atomic, "discard_unfinished"):
        atomic.discard_unfinished()
    blender = sys.modules.get("_bpy")
    if hasattr(blender, "app"):
        shutil.rmtree(blender.app.tempdir, ignore_errors=True)
    for _ in range(3):  # a render that is about to write makes its folder anew
        _remove(scratch)
        time.sleep(0.02)
    _remove(scratch)


def _remove(folder):
    """Remove a folder into which the main thread may be writing: first out of its way, under another name."""
    gone = f"{folder}.gone"
    with suppress(FileNotFoundError):  # the main thread was about to remove it, too
        os.replace(folder, gone)
    shutil.rmtree(gone, ignore_errors=True)
