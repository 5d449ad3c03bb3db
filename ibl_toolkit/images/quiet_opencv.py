"""OpenCV without the lines that it prints of files which it cannot read."""

import contextlib

import cv2

_LOGGING = getattr(cv2.utils, "logging", cv2)  # there since OpenCV 5
_SILENT = 0


@contextlib.contextmanager
def quiet_opencv():
    """Print nothing meanwhile; what is wrong is told by whoever asked."""
    level = _LOGGING.getLogLevel()
    _LOGGING.setLogLevel(_SILENT)
    try:
        yield
    finally:
        _LOGGING.setLogLevel(level)
