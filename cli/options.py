"""Values of options: what is accepted, and what is said about the rest."""

import argparse
import math
import re
from itertools import pairwise

_RANGE = re.compile(r"(-?\d+)(?:-(-?\d+))?(?:,(\d+))?")
_MANY = 2**31 - 1
_LAST_FRAME = 1_048_574  # of Blender


def whole_number(least, most=_MANY):
    """Return a parser of whole numbers from `least` to `most`.

    >>> whole_number(1)("64")
    64
    """

    def read(text):
        if not re.fullmatch(r"[+-]?\d+", text) or not least <= int(text) <= most:
            limit = f"at least {least}" if most == _MANY else f"{least} to {most}"
            raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number, {limit}")
        return int(text)

    return read


def whole_numbers(least, most):
    """Return a parser of whole numbers from `least` to `most`, with commas.

    >>> whole_numbers(16, 4096)("512,1024")
    (512, 1024)
    """
    one = whole_number(least, most)
    return lambda text: tuple(one(part) for part in text.split(","))


def some_of(choices):
    """Return a parser of some of the choices, with commas.

    >>> some_of(("hard", "pcf"))("pcf,hard")
    ('pcf', 'hard')
    """

    def read(text):
        wanted = tuple(text.split(","))
        for one in wanted:
            if one not in choices:
                raise argparse.ArgumentTypeError(f"{one!r}: must be one or more of {', '.join(choices)}")
        return wanted

    return read


def light_limit(text):
    """The most lights that are taken out of the map: `auto` (None: as many as there are), `none` (0) or N.

    >>> light_limit("auto"), light_limit("none"), light_limit("4")
    (None, 0, 4)
    """
    if text == "auto":
        return None
    if text == "none":
        return 0
    if text.isascii() and text.isdigit():
        return int(text)
    raise argparse.ArgumentTypeError(f"{text!r}: must be auto, none or a number of lights")


def frame_range(text):
    """Frames `A`, `A-B` or `A-B,step` -> range.

    >>> list(frame_range("1-10,4")), list(frame_range("7"))
    ([1, 5, 9], [7])
    """
    found = _RANGE.fullmatch(text)
    if found:
        first, last, step = found[1], found[2] or found[1], found[3] or 1
        frames = range(int(first), int(last) + 1, max(int(step), 1))
        if frames and int(step) and max(map(abs, (frames[0], frames[-1]))) <= _LAST_FRAME:
            return frames
    raise argparse.ArgumentTypeError(f"{text!r}: must be A, A-B or A-B,step with A ≤ B and a step from 1")


def share_of_light(text):
    """A share above 0 and below 1, or `auto` (None).

    >>> share_of_light("auto"), share_of_light("0.5")
    (None, 0.5)
    """
    if text == "auto":
        return None
    share = _number(text)
    if share is None or not 0 < share < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: must be auto or a share above 0 and below 1")
    return share


def one_or_three(text):
    """A number, or three of them with commas: R,G,B -> tuple.

    >>> one_or_three("2.5"), one_or_three("3,2,1")
    ((2.5,), (3.0, 2.0, 1.0))
    """
    numbers = tuple(_number(part) for part in text.split(","))
    if len(numbers) not in (1, 3) or None in numbers:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a number, or R,G,B")
    return numbers


def rising(text):
    """Numbers above 0 with commas, each larger than the one before -> tuple.

    >>> rising("1,2.5")
    (1.0, 2.5)
    """
    numbers = tuple(positive(part) for part in text.split(","))
    if any(later <= earlier for earlier, later in pairwise(numbers)):
        raise argparse.ArgumentTypeError(f"{text!r}: must rise from number to number")
    return numbers


def finite(text):
    """A finite number.

    >>> finite("-22.9")
    -22.9
    """
    number = _number(text)
    if number is None:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a number")
    return number


def positive(text):
    """A finite number above 0.

    >>> positive("0.5")
    0.5
    """
    number = _number(text)
    if number is None or number <= 0:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a number above 0")
    return number


def _number(text):
    """A finite number, or None."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
