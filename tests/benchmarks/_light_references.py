"""Converged pictures without any split, rendered once and kept in out/bench/light/: two halves per case."""

import os
import sys

import _light_cases as cases
import numpy as np

HALF_SAMPLES = {"room, large lamps": 1024, "room, small lamps": 512, "hotel room": 512, "studio": 512}
MAP_HALF_SAMPLES = 128
SEEDS = 101, 202


def half_samples(case):
    """Samples of each half: what the noise asks for."""
    return HALF_SAMPLES.get(case.place, MAP_HALF_SAMPLES)


def reference(case):
    """The two halves (H, W, 3) of a case's reference, rendered unless they are there."""
    paths = [path_of(case, number) for number in range(len(SEEDS))]
    lit = None
    for path, seed in zip(paths, SEEDS, strict=True):
        if not path.exists():
            lit = lit or cases.light(case, cases.REFERENCE)
            picture, seconds = lit.render(half_samples(case), seed)
            temporary = path.with_suffix(".part.npy")
            np.save(temporary, picture)
            os.replace(temporary, path)
            print(f"reference {path.stem}: {seconds:.0f} processor seconds", file=sys.stderr, flush=True)
    return [np.load(path) for path in paths]


def path_of(case, number):
    """The file of one half."""
    return cases.CACHE / f"{case.slug}_{cases.WIDTH}x{cases.HEIGHT}_{half_samples(case)}_{number}.npy"


def main():
    """Render all that are missing."""
    cases.CACHE.mkdir(parents=True, exist_ok=True)
    for case in cases.all_cases():
        reference(case)


if __name__ == "__main__":
    cases.cycles_integration.register()
    main()
