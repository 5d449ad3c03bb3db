"""What `light_rendering` makes of its pictures: errors, seconds of a whole picture, time to equal error."""

import flip_evaluator
import numpy as np
from _light_cases import HEIGHT, WIDTH

from expanded_panoramas.ibl_toolkit import metrics
from expanded_panoramas.ibl_toolkit.images import exposure_for
from expanded_panoramas.ibl_toolkit.light.light_map import LUMINANCE

PICTURE = 960, 540
TIMES_AS_MANY = PICTURE[0] * PICTURE[1] / (WIDTH * HEIGHT)
DOTS_AT = 64, 256
TARGETS = 9
DEFINITIONS = {
    "mse": "linear radiance times the exposure that brings the reference's median to mid grey, clipped to "
    "[0, 1] so that a lamp's own pixels do not drown all else; mean of (a - r1)(a - r2), with r1 and r2 the "
    "independent halves of the reference, so that the reference's noise adds nothing",
    "mse_unclipped": "the same without the clip",
    "flip": "mean of NVIDIA's LDR-FLIP (67 pixels per degree) against the mean of both halves, so exposed",
    "processor_seconds": "of all threads, around the render of one picture",
    "seconds": f"processor seconds of a picture of {PICTURE[0]} x {PICTURE[1]} pixels: start + samples "
    "x per_sample x its pixels over those of the benchmark's; start and per_sample by the least time "
    "of the rounds at the fewest and the most samples",
    "time_ratio": "seconds that the plain set-up needs over those of this way, at equal error: geometric "
    f"mean over {TARGETS} errors that both curves reach, straight lines in log-log between measured points, "
    "error x time constant beyond them. In the rooms, where the clip hides white dots, the plain mesh's "
    "error hardly falls with time, and the ratio is a lower bound",
    "bias_percent": "of mean unclipped radiance against the reference's, with its standard error",
    "white_dots": "pixels more than ten times above their neighbours and not so in the reference; per "
    "samples, mean over the rounds",
}


def curve(runs, halves):
    """Figures of one way to light a case: ``runs`` {samples: [(picture, processor seconds), …]}."""
    exposure = exposure_for(np.mean(halves, axis=0))
    start, per_sample = cost(runs)
    points = []
    for samples, rounds in sorted(runs.items()):
        pictures = [picture for picture, _ in rounds]
        clipped = [np.clip(half * exposure, 0, 1) for half in halves]
        points.append(
            {
                "samples": samples,
                "seconds": rounded(start + samples * per_sample * TIMES_AS_MANY),
                "processor_seconds": [rounded(seconds) for _, seconds in rounds],
                "mse": rounded(np.mean([mse(np.clip(p * exposure, 0, 1), clipped) for p in pictures])),
                "mse_unclipped": rounded(
                    np.mean([mse(p * exposure, np.multiply(halves, exposure)) for p in pictures])
                ),
                "flip": rounded(np.mean([flip(p * exposure, np.mean(clipped, axis=0)) for p in pictures])),
            }
        )
    bias, error = bias_percent(runs, halves)
    return {
        "start_seconds": rounded(start),
        "per_sample_seconds": rounded(per_sample),
        "bias_percent": rounded(bias),
        "bias_standard_error": rounded(error),
        "white_dots": white_dots(runs, halves),
        "points": points,
    }


def mse(picture, halves):
    """Mean square error against both halves of a reference."""
    return float(np.mean((picture - halves[0]) * (picture - halves[1]), dtype=np.float64))


def flip(picture, reference):
    """Mean FLIP of linear pictures in [0, 1]."""
    shown = [metrics.display_values(image).astype(np.float32) for image in (reference, picture)]
    return flip_evaluator.evaluate(*shown, "LDR", applyMagma=False)[1]


def cost(runs):
    """Processor seconds: what a render takes before its first sample, and each sample of all pixels."""
    least = {samples: min(seconds for _, seconds in rounds) for samples, rounds in runs.items()}
    few, many = min(least), max(least)
    per_sample = (least[many] - least[few]) / (many - few)
    return max(least[few] - few * per_sample, 0.0), per_sample


def bias_percent(runs, halves):
    """Mean radiance above the reference's [%], and the standard error of that."""
    pictures = [(samples, picture) for samples, rounds in runs.items() for picture, _ in rounds]
    weights = [samples for samples, _ in pictures]
    mean = np.average([picture for _, picture in pictures], axis=0, weights=weights) @ LUMINANCE
    reference = np.mean(halves, axis=0) @ LUMINANCE
    of_pixels = (mean - reference).std() / np.sqrt(mean.size)  # noise is independent from pixel to pixel
    return 100 * (mean.mean() / reference.mean() - 1), 100 * of_pixels / reference.mean()


def white_dots(runs, halves):
    """Mean count of new white dots, by samples."""
    reference = np.mean(halves, axis=0)
    return {
        samples: float(np.mean([metrics.new_white_dots(picture, reference).sum() for picture, _ in rounds]))
        for samples, rounds in runs.items()
        if samples in DOTS_AT
    }


def time_ratio(plain, other, error="mse"):
    """Seconds of the plain set-up over the other's at equal error."""
    curves = [_descending(row["points"], error) for row in (plain, other)]
    low = max(curve[1].min() for curve in curves)
    high = min(curve[1].max() for curve in curves)
    targets = np.linspace(low, high, TARGETS) if low < high else np.array([(low + high) / 2])
    logs = [_log_seconds(curve, targets) for curve in curves]
    return rounded(np.exp(np.mean(logs[0] - logs[1])))


def geometric_mean(values):
    """Of positive numbers."""
    return rounded(np.exp(np.mean(np.log(values))))


def rounded(number):
    """Four digits."""
    return float(f"{number:.4g}")


def _descending(points, error):
    """Logarithms of seconds and error, as far as the error is told from 0 and falls."""
    seconds, errors = (np.array([point[key] for point in points]) for key in ("seconds", error))
    falls = (errors > 0) & (errors <= np.minimum.accumulate(errors))
    return np.log(seconds[falls]), np.log(errors[falls])


def _log_seconds(curve, targets):
    seconds, errors = curve
    inside = np.interp(-targets, -errors, seconds)
    return inside + (np.maximum(errors[-1] - targets, 0) - np.maximum(targets - errors[0], 0))
