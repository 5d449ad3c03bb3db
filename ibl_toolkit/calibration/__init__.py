"""Calibration of a panorama from picks: thesis section 5.4."""

from .calibration import Calibration, calibrate
from .click_report import ClickReport, calibrate_with_report
from .picks import CalibrationError, CalibrationPicks, KnownLength, Parallels, Rectangle

__all__ = [
    "Calibration",
    "CalibrationError",
    "CalibrationPicks",
    "ClickReport",
    "KnownLength",
    "Parallels",
    "Rectangle",
    "calibrate",
    "calibrate_with_report",
]
