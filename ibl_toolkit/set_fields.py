"""Checked access to the keys of a JSON object; every refusal names the full path of the key."""

import math

import numpy as np

REQUIRED = object()


class SetError(ValueError):
    """A panorama set that is not valid; the message names the key, its value and what would be right."""


class Fields:
    """One JSON object at `path`. Each key is asked for once; `finish` refuses those that nobody asked for.

    >>> Fields({"camera_height": -1}, "calibration").number("camera_height", above=0)
    Traceback (most recent call last):
    ...
    expanded_panoramas.ibl_toolkit.set_fields.SetError: calibration.camera_height is -1, must be above 0
    """

    def __init__(self, value, path):
        if not isinstance(value, dict):
            raise SetError(f"{path or 'the set'} is {_shown(value)}, must be an object")
        self._values, self._path, self._asked = value, path, set()

    def key(self, name):
        """Full path of a key."""
        return f"{self._path}.{name}" if self._path else name

    def finish(self):
        """Refuse keys that were not asked for."""
        unknown = [name for name in self._values if name not in self._asked]
        if unknown:
            known = ", ".join(sorted(self._asked))
            raise SetError(f"{self.key(unknown[0])} is an unknown key; known here: {known}")

    def _take(self, name, default):
        self._asked.add(name)
        if name in self._values:
            return True, self._values[name]
        if default is REQUIRED:
            raise SetError(f"{self.key(name)} is missing")
        return False, default

    def _refuse(self, name, value, right):
        raise SetError(f"{self.key(name)} is {_shown(value)}, must be {right}")

    def text(self, name, default=REQUIRED):
        """A string that is not blank."""
        there, value = self._take(name, default)
        if there and not (isinstance(value, str) and value.strip()):
            self._refuse(name, value, "text")
        return value

    def boolean(self, name, default=REQUIRED):
        """true or false."""
        there, value = self._take(name, default)
        if there and not isinstance(value, bool):
            self._refuse(name, value, "true or false")
        return value

    def integer(self, name):
        """A whole number."""
        _, value = self._take(name, REQUIRED)
        if not isinstance(value, int) or isinstance(value, bool):
            self._refuse(name, value, "a whole number")
        return value

    def choice(self, name, choices):
        """One of some strings."""
        _, value = self._take(name, REQUIRED)
        if not isinstance(value, str) or value not in choices:
            self._refuse(name, value, "one of " + ", ".join(choices))
        return value

    def number(self, name, above=None, least=None, most=None, default=REQUIRED):
        """A finite number, above one bound or between two."""
        there, value = self._take(name, default)
        if not there:
            return value
        if not _is_number(value):
            self._refuse(name, value, "a number")
        if above is not None and not value > above:
            self._refuse(name, value, f"above {above}")
        if least is not None and not least <= value <= most:
            self._refuse(name, value, f"from {least} to {most}")
        return float(value)

    def object(self, name, default=REQUIRED):
        """A nested object -> Fields."""
        there, value = self._take(name, default)
        return Fields(value, self.key(name)) if there else value

    def objects(self, name, default=REQUIRED):
        """A list of objects -> list of Fields."""
        there, value = self._take(name, default)
        if not there:
            return value
        return [Fields(item, f"{self.key(name)}[{i}]") for i, item in enumerate(_list(value, self.key(name)))]

    def point(self, name, default=REQUIRED):
        """A pick [u, v] -> (2,)."""
        there, value = self._take(name, default)
        return np.array(_point(value, self.key(name))) if there else value

    def vector(self, name, default=REQUIRED):
        """Three finite numbers -> (3,)."""
        there, value = self._take(name, default)
        if not there:
            return value
        if not isinstance(value, list) or len(value) != 3 or not all(_is_number(number) for number in value):
            self._refuse(name, value, "three numbers")
        return np.array(value, dtype=np.float64)

    def points(self, name, count, exactly):
        """A list of `count` picks, or of at least so many -> (n, 2)."""
        _, value = self._take(name, REQUIRED)
        return np.array(_points(value, self.key(name), count, exactly))

    def lines(self, name, default=REQUIRED):
        """A list of lines, each of two picks -> (n, 2, 2)."""
        there, value = self._take(name, default)
        if not there:
            return value
        path = self.key(name)
        lines = [_points(line, f"{path}[{i}]", 2, True) for i, line in enumerate(_list(value, path))]
        return np.array(lines).reshape(-1, 2, 2)


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _list(value, path):
    if not isinstance(value, list):
        raise SetError(f"{path} is {_shown(value)}, must be a list")
    return value


def _points(value, path, count, exactly):
    if len(_list(value, path)) < count or (exactly and len(value) != count):
        raise SetError(f"{path} has {len(value)} points, must have {count}{'' if exactly else ' or more'}")
    return [_point(item, f"{path}[{i}]") for i, item in enumerate(value)]


def _point(value, path):
    if not isinstance(value, list) or len(value) != 2 or not all(_is_number(number) for number in value):
        raise SetError(f"{path} is {_shown(value)}, must be a pick [u, v]")
    if not all(0 <= number <= 1 for number in value):
        raise SetError(f"{path} is {_shown(value)}, must lie in the image: u and v from 0 to 1")
    return [float(number) for number in value]


def _shown(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "…"
