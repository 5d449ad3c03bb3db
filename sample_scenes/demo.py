"""The whole job on a real panorama, as `./run demo` does it: from the hotel room's picks to pictures.

Writes out/demo/: the set and its image, `depth.exr` (RGB-D), `frame.exr` and `panorama.exr` with their PNGs,
`report.json`, and `index.html`, which shows it all. The files are made elsewhere and put there when all are
done, so a run that is stopped leaves what was there.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from ..cli import blender, interruption, stdout
from ..cli.progress import Progress

ROOT = Path(__file__).resolve().parents[1]


def main(argv=None):
    """Run the demo from a shell; returns the exit status."""
    parser = argparse.ArgumentParser(prog="demo", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "demo", help="folder to write")
    parser.add_argument("--quick", action="store_true", help="tiny pictures, to see that everything works")
    parser.add_argument("--docs", action="store_true", help="then make the pictures of README and manual")
    arguments = parser.parse_args(argv)
    with interruption.watched("demo") as watch:
        progress = Progress(sys.stderr if sys.stderr.isatty() else None)
        watch.clear = progress.clear
        from .demo_job import FULL, QUICK  # bpy takes a moment, in which Ctrl-C should end the run as ever

        with stdout.kept_for_results():
            report = run_demo(arguments.out, QUICK if arguments.quick else FULL, progress)
    for name, seconds in report["seconds"].items():
        print(f"demo: {name:<12}{seconds:8.1f} s")
    if arguments.docs:
        from . import demo_docs

        demo_docs.write_pictures(arguments.out, ROOT / "docs" / "images")
    return 0


def run_demo(folder, effort, progress=None) -> dict:
    """Do the whole job and put its results into ``folder``; returns the report."""
    from ..ibl_toolkit.images import replacing
    from .demo_job import run_job

    progress = progress or Progress()
    folder = Path(folder)
    with tempfile.TemporaryDirectory(prefix="demo_") as finished:
        with blender.empty_scene(progress) as scene:
            report = run_job(scene, Path(finished), effort, progress)
        folder.mkdir(parents=True, exist_ok=True)
        for file in sorted(Path(finished).iterdir()):
            with replacing(folder / file.name) as temporary:
                shutil.copyfile(file, temporary)
    return report


if __name__ == "__main__":
    sys.exit(main())
