"""Lengths as the scene's units write them, read and typed while something is drawn."""

from __future__ import annotations

import re
from dataclasses import dataclass

import bpy

DIGITS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")
CHARACTERS = {
    **{name: str(digit) for digit, name in enumerate(DIGITS)},
    **{f"NUMPAD_{digit}": str(digit) for digit in range(10)},
    **{"PERIOD": ".", "NUMPAD_PERIOD": ".", "COMMA": ","},
}
UNITS = "km|hm|dam|dm|cm|mm|um|µm|m|mi|ft|in|yd|thou|mil|'|\""
IN_UNITS = {" ", *UNITS.replace("|", "")}
NUMBER, UNIT = r"(?:\d+\.?\d*|\.\d+) *", f"(?:{UNITS}) *"
LENGTH = re.compile(f"(?:{NUMBER}{UNIT})+|{NUMBER}")
"""Such as 2.5, 250 cm, 6'2\"; what else Blender would evaluate, it prints errors of, and goes wrong with."""
SYMBOLS = {
    "KILOMETERS": "km",
    "METERS": "m",
    "CENTIMETERS": "cm",
    "MILLIMETERS": "mm",
    "MICROMETERS": "um",
    "MILES": "mi",
    "FEET": "ft",
    "INCHES": "in",
    "THOU": "thou",
}
DECIMALS = 3
LONGEST = 1e5
"""Longest length that can be typed [m]."""


@dataclass(frozen=True)
class Lengths:
    """A scene's units: their system, the unit of plain numbers ("" for the system's own), metres per unit of
    the world."""

    system: str
    unit: str
    scale: float

    @classmethod
    def of_scene(cls, scene):
        """Those of a scene."""
        settings = scene.unit_settings
        return cls(settings.system, SYMBOLS.get(settings.length_unit, ""), settings.scale_length)

    def value(self, typed) -> float:
        """The length that was typed, in units of the world [m]. Raises ValueError where it is none."""
        typed = typed.replace(",", ".").strip()
        if not LENGTH.fullmatch(typed):
            raise ValueError(f"'{typed}' is no length, such as 2.5 or 250 cm")
        found = bpy.utils.units.to_value(self.system, "LENGTH", typed, str_ref_unit=self.unit or None)
        length = found / self.scale
        if not 0 < length < LONGEST:
            raise ValueError(f"'{typed}': a length must be above 0 and below {LONGEST:.0f} m")
        return length

    def text(self, length) -> str:
        """A length [m] as the scene's units write it."""
        length = length * self.scale
        if self.unit:
            one = bpy.utils.units.to_value(self.system, "LENGTH", f"1{self.unit}")
            return f"{length / one:.{DECIMALS}f} {self.unit}"
        if self.system == "NONE":
            return f"{length:.{DECIMALS}f}"
        return bpy.utils.units.to_string(self.system, "LENGTH", length, precision=DECIMALS)


def typed_character(event, typed) -> str:
    """What a key press adds to the length typed so far; "" where it does not belong to one."""
    for character in (
        event.unicode.lower(),
        CHARACTERS.get(event.type, ""),
    ):  # the second where Shift is held
        is_number = character.isdigit() or character in (".", ",")
        if not event.ctrl and (is_number or (typed and character in IN_UNITS)):
            return character
    return ""
