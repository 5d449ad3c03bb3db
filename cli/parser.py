"""The arguments of all verbs."""

import argparse
from pathlib import Path

from . import (
    batch,
    build,
    calibrate,
    depth,
    export,
    layers,
    lights,
    probe,
    render,
    shadow_preview,
    sun,
    view,
)
from .messages import warn

VERBS = {
    "calibrate": calibrate,
    "build": build,
    "depth": depth,
    "lights": lights,
    "probe": probe,
    "render": render,
    "layers": layers,
    "view": view,
    "export": export,
    "shadow-preview": shadow_preview,
}
WITHOUT_SET = {"sun": sun}
"""Verbs whose options say all: no input file, no output, and nothing to do in a batch."""


class _Parser(argparse.ArgumentParser):
    """An argument parser whose complaint is one line."""

    def error(self, message):
        """Print `message` without the usage text and exit with 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser():
    """Return the parser of all verbs.

    Each verb's parser sets the default `job`: a function of the parsed arguments and a Progress that returns
    what `--json` prints and the exit status, and raises ValueError or OSError for bad input.
    """
    root = _Parser(prog="panorama", description="Light, rebuild and render inside an HDR panorama.")
    verbs = _verbs_of(root, "verb")
    for name, module in VERBS.items():
        verb = verbs.add_parser(name, help=module.SUMMARY, description=_sentence(module.SUMMARY))
        verb.add_argument("set", metavar="INPUT", type=Path, help=module.INPUT)
        verb.add_argument(
            "-o",
            "--output",
            metavar=module.OUTPUT,
            type=Path,
            required=module.NEEDS_OUTPUT,
            help=f"{'folder' if module.OUTPUT == 'FOLDER' else 'file'} to write",
        )
        module.add_options(verb)
        _add_common(verb)
        verb.set_defaults(module=module, job=_run_one, describe=module.describe)
    for name, module in WITHOUT_SET.items():
        verb = verbs.add_parser(name, help=module.SUMMARY, description=_sentence(module.SUMMARY))
        module.add_options(verb)
        _add_common(verb)
        verb.set_defaults(module=module, job=_run_without_set, describe=module.describe)
    _add_batch(verbs)
    return root


def _add_batch(verbs):
    root = verbs.add_parser("batch", help=batch.SUMMARY, description=_sentence(batch.SUMMARY))
    inner = _verbs_of(root, "batch_verb")
    for name, module in VERBS.items():
        verb = inner.add_parser(name, help=module.SUMMARY)
        verb.add_argument("sets", metavar="INPUT", type=Path, nargs="+", help=module.INPUT)
        verb.add_argument(
            "--into", metavar="FOLDER", type=Path, required=True, help=f"for INPUT{module.SUFFIX}"
        )
        module.add_options(verb)
        _add_common(verb)
        verb.set_defaults(module=module, job=batch.run, describe=batch.describe)


def _verbs_of(root, name):
    return root.add_subparsers(title="verbs", metavar="VERB", dest=name, required=True, parser_class=_Parser)


def _add_common(verb):
    verb.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    verb.add_argument(
        "--quiet", action="store_true", help="show no progress on stderr, not even in a terminal"
    )


def _run_one(arguments, progress):
    """Do a verb on one set -> what it prints, exit status."""
    result = arguments.module.run(arguments.set, arguments.output, arguments, progress)
    if not arguments.json:
        warn(arguments.verb, arguments.set, result)
    return result, 0


def _run_without_set(arguments, progress):
    """Do a verb that needs no set -> what it prints, exit status."""
    result = arguments.module.run(arguments, progress)
    if not arguments.json:
        warn(arguments.verb, None, result)
    return result, 0


def _sentence(text):
    return text[0].upper() + text[1:] + "."
