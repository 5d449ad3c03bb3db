"""`panorama calibrate SET`: orientation and scale of a panorama, and how far to trust them."""

import json

from ..ibl_toolkit.images import replacing
from .job import open_job, refuse_output

INPUT = "panorama set (.json)"
SUMMARY = "solve orientation and scale from the picks"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "RESULT.json", "_calibration.json", False


def add_options(_parser):
    """It has none."""


def run(set_path, output, _options, progress):
    """Do the verb -> what `--json` prints."""
    return calibrate_set(set_path, output, progress)


def calibrate_set(set_path, output=None, progress=None):
    """Calibrate a set -> a dict, the result of --json; also written to `output` (.json) where given."""
    job = open_job(set_path)
    result = job.calibration.to_json()
    if output is not None:
        refuse_output(output, ".json", (job.path, job.set.image))
        with replacing(output) as temporary:
            temporary.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return result


def describe(result):
    """Lines for people."""
    sure = result["uncertainty"]
    return [
        f"tilt           {result['tilt_deg']:.3f}° ± {sure['tilt_deg']:.3f}°",
        f"camera height  {result['camera_height']:.3f} m, scale ± {sure['scale_percent']:.2f} %",
        f"residual       {result['residual_deg']:.3f}°",
        f"condition      {result['condition']:.1f}",
    ]
