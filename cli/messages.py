"""What the command line says on stderr: one line for each thing."""

import sys


def complain(verb, text):
    """Print one line that says which verb it is about."""
    print(f"panorama {verb}: {text}", file=sys.stderr)


def one_line(error):
    """The message of an error; of a file that cannot be opened: its name, then why.

    >>> one_line(FileNotFoundError(2, "No such file or directory", "room.json"))
    'room.json: No such file or directory'
    """
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return " ".join(str(error).split())


def warn(verb, set_path, result):
    """Print the warnings of a result, its own and those of its shapes; set_path: None for a verb without."""
    start = "warning" if set_path is None else f"{set_path}: warning"
    for text in result.get("warnings", ()):
        complain(verb, f"{start}: {text}")
    for shape in result.get("shapes", ()):
        for text in shape["warnings"]:
            complain(verb, f"{start}: shape '{shape['name']}': {text}")
