"""Files that are whole or absent: written beside their target, then renamed over it."""

import os
import secrets
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

_unfinished = set()


@contextmanager
def replacing(path):
    """A temporary path beside `path`, with its suffix, that becomes `path` when the block succeeds.

    If the block fails or is interrupted (KeyboardInterrupt included), what it wrote is deleted and the
    old file, if any, stays.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with replacing(Path(folder) / "a.txt") as temporary:
    ...         _ = temporary.write_text("whole")
    ...     (Path(folder) / "a.txt").read_text()
    'whole'
    """
    path = Path(path)
    # Hidden and random: two runs with the same target don't write into each other's file.
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.part{path.suffix}")
    _unfinished.add(temporary)
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
        _unfinished.discard(temporary)


@contextmanager
def new_folder(path):
    """A temporary folder beside `path`, which must not be there, that becomes `path` when the block succeeds.

    If the block fails or is interrupted, the folder is deleted with all that is in it.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    _unfinished.add(temporary)
    try:
        temporary.mkdir()
        yield temporary
        temporary.rename(path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        _unfinished.discard(temporary)


def refuse_unwritable(path):
    """Raise OSError where no file can be written to `path`: asked before long work that ends with one."""
    handle, name = tempfile.mkstemp(prefix=".", suffix=".part", dir=Path(path).absolute().parent)
    os.close(handle)
    os.unlink(name)


def discard_unfinished():
    """Delete what `replacing` has not finished: for a process that ends without unwinding its stack."""
    for temporary in tuple(_unfinished):
        if temporary.is_dir():
            shutil.rmtree(temporary, ignore_errors=True)
        else:
            temporary.unlink(missing_ok=True)
