"""What every verb begins with: the set is read, calibrated and rebuilt, before Blender is needed."""

import os
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..ibl_toolkit.calibration import Calibration, calibrate
from ..ibl_toolkit.images import ImageError, panorama_size
from ..ibl_toolkit.panorama_set import PanoramaSet, read_set
from ..ibl_toolkit.reconstruction import Piece, reconstruct


@dataclass(frozen=True)
class Job:
    """A set with what follows from its picks alone; image_size (width, height) [px]."""

    path: Path
    set: PanoramaSet
    image_size: tuple[int, int]
    calibration: Calibration


def open_job(set_path):
    """Read and calibrate a set -> Job. Raises ValueError that begins with the set's path; OSError."""
    path = Path(set_path)
    panorama_set = read_set(path)
    try:
        size = panorama_size(panorama_set.image)
    except OSError as error:
        raise ValueError(f"{path}: image: {panorama_set.image}: {error.strerror}") from error
    except ImageError as error:
        raise ValueError(f"{path}: image: {error}") from error
    with naming(path):
        calibration = calibrate(panorama_set.calibration, size)
    return Job(path, panorama_set, size, calibration)


def rebuild(job) -> tuple[Piece, ...]:
    """Rebuild the set's shapes. Raises ValueError that begins with the set's path."""
    with naming(job.path):
        return reconstruct(job.set, job.calibration, job.image_size[0])


def place_in(scene, job, pieces):
    """Put a calibrated panorama and its rebuilt shapes into a scene of Blender -> its place."""
    from ..cycles_integration import place
    from ..cycles_integration.pieces import update_pieces

    made = place.create_place(scene, str(job.set.image.absolute()), job.calibration)
    update_pieces(made, pieces)
    return made


@contextmanager
def naming(path):
    """Put a file's path before the message of any ValueError of the block."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def refuse_output(output, suffix, inputs, option="-o"):
    """Raise ValueError unless a file of this suffix can be written at `output` without harm to an input.

    Before the work: a render of an hour must not end at a folder that isn't there.
    """
    output = Path(output)
    if output.suffix.lower() != suffix:
        raise ValueError(f"{option} {output}: must end in {suffix}")
    if not output.parent.is_dir():
        raise ValueError(f"{option} {output}: folder {output.parent} does not exist")
    if output.is_dir() or not os.access(output.parent, os.W_OK):
        raise ValueError(f"{option} {output}: cannot be written")
    for path in inputs:
        if path is not None and output.exists() and path.exists() and output.samefile(path):
            raise ValueError(f"{option} {output}: would overwrite an input of the job")
