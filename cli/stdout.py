"""stdout is for results: what Blender and Cycles print there from their C code goes nowhere."""

import ctypes
import os
import sys
from contextlib import contextmanager, redirect_stdout

_STDOUT = 1


@contextmanager
def kept_for_results():
    """While the block runs, nothing reaches the process's stdout, from C or from Python."""
    flush()
    kept = os.dup(_STDOUT)
    silence()
    try:
        with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere):  # which may have another descriptor
            yield
    finally:
        flush()
        os.dup2(kept, _STDOUT)
        os.close(kept)


def silence():
    """Send the process's stdout nowhere from here on."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, _STDOUT)
    os.close(nowhere)


def flush():
    """Write out what is buffered: C has a buffer of its own, which would be written whenever it is full."""
    sys.stdout.flush()
    library = "ucrtbase" if sys.platform == "win32" else None
    ctypes.CDLL(library).fflush(None)
