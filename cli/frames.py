"""Files of a frame range: their names, and which of them are complete."""

import re
from pathlib import Path

from ..ibl_toolkit.images import ImageError
from ..ibl_toolkit.images.exr_header import read_header, refuse_truncated, window_height, window_width

_PADDING = re.compile(r"#+")


def frame_paths(output, frames):
    """The file of each frame: the last run of # in the name stands for its number, as in Blender.

    frames: None for one picture, whose name is taken as it is.

    >>> {number: path.name for number, path in frame_paths("out/a_###.exr", range(9, 12, 2)).items()}
    {9: 'a_009.exr', 11: 'a_011.exr'}

    Raises: ValueError for # without a range, and for a range of several without #.
    """
    output = Path(output)
    runs = list(_PADDING.finditer(output.name))
    if frames is None:
        if runs:
            raise ValueError(f"-o {output}: # stands for the number of a frame, so --frames must be given")
        return {None: output}
    if not runs and len(frames) > 1:
        raise ValueError(f"-o {output}: one name for {len(frames)} frames; let #### stand for their number")
    return {number: output.with_name(_numbered(output.name, runs, number)) for number in frames}


def is_complete(path, size):
    """Whether there is a whole EXR of this (width, height) [px] at a path; reads no pixels."""
    if not path.exists():
        return False
    try:
        window = read_header(path)[0].display_window
        refuse_truncated(path)
    except ImageError:
        return False
    return (window_width(window), window_height(window)) == tuple(size)


def _numbered(name, runs, number):
    if not runs:
        return name
    start, end = runs[-1].span()
    digits = f"{'-' * (number < 0)}{abs(number):0{end - start}}"
    return name[:start] + digits + name[end:]
