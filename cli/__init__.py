"""`panorama VERB …`: one sub-command per job, in a shell and as `blender --background --command panorama`.

Exit status: 0; 2 for bad input, with one line on stderr that says what, where and what would be right; 130
after Ctrl-C. Each verb is a module: `add_options(parser)`, `run(set_path, output, options, progress)`, which
returns what `--json` prints, and `describe(result)`, the lines that are printed without it. Their jobs are
functions too: `calibrate_set`, `build_scene`, `write_depth`, `render_set`.
"""

import json
import sys

from . import interruption, stdout
from .messages import complain, one_line
from .progress import Progress

_blender_command = None


def main(argv=None):
    """Run one verb and return its exit status."""
    argv = sys.argv[1:] if argv is None else argv
    for stream in (sys.stdout, sys.stderr):  # a terminal without ± or × shows ? there
        stream.reconfigure(errors="replace")
    with interruption.watched(" ".join(["panorama", *argv[:1]])) as watch:
        from .parser import parser  # takes a moment, in which Ctrl-C should end the run as at any other

        arguments = parser().parse_args(argv)
        progress = Progress(None if arguments.quiet or not sys.stderr.isatty() else sys.stderr)
        watch.clear = progress.clear
        try:
            with stdout.kept_for_results():
                result, status = arguments.job(arguments, progress)
        except (ValueError, OSError) as error:
            complain(arguments.verb, one_line(error))
            return 2
        print(json.dumps(result, indent=2) if arguments.json else "\n".join(arguments.describe(result)))
        return status


def _blender_main(argv):
    """Run `main` for Blender, which wants a status where argparse exits, and prints as it leaves."""
    try:
        status = main(argv)
    except SystemExit as stop:
        status = stop.code
    sys.stdout.flush()
    stdout.silence()
    return status


def register():
    """Make `blender --command panorama` known."""
    global _blender_command
    import bpy

    _blender_command = bpy.utils.register_cli_command("panorama", _blender_main)


def unregister():
    """Take the command back."""
    global _blender_command
    import bpy

    bpy.utils.unregister_cli_command(_blender_command)
    _blender_command = None
