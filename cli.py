"""`panorama VERB …`: one sub-command per job, in a shell and as `blender --background --command panorama`.

Exit status: 0; 2 for bad input, with one line on stderr that says what, where and what would be right.
"""

import argparse
import sys

_blender_command = None


class _Parser(argparse.ArgumentParser):
    """An argument parser whose complaint is one line."""

    def error(self, message):
        """Print `message` without the usage text and exit with 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser():
    """Return the parser of all verbs.

    Each verb's parser sets the default `run`: a function of the parsed arguments that returns what `--json`
    prints, and raises ValueError or OSError for bad input.
    """
    root = _Parser(prog="panorama", description="Light, rebuild and render inside an HDR panorama.")
    root.add_subparsers(title="verbs", metavar="VERB", dest="verb", required=True, parser_class=_Parser)
    return root


def main(argv=None):
    """Run one verb and return its exit status."""
    arguments = parser().parse_args(argv)
    try:
        arguments.run(arguments)
    except (ValueError, OSError) as error:
        print(f"panorama {arguments.verb}: {error}", file=sys.stderr)
        return 2
    return 0


def _blender_main(argv):
    """Run `main` for Blender, which wants a status where argparse exits."""
    try:
        return main(argv)
    except SystemExit as stop:
        return stop.code


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


if __name__ == "__main__":
    sys.exit(main())
