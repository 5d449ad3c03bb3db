"""Calibration of a panorama from picks: thesis section 5.4."""

from .calibration import Calibration, calibrate
from .picks import CalibrationError, CalibrationPicks, KnownLength, Parallels, Rectangle

__all__ = [
    "Calibration",
    "CalibrationError",
    "CalibrationPicks",
    "KnownLength",
    "Parallels",
    "Rectangle",
    "calibrate",
]
