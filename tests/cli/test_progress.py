"""The line on stderr, the values of options, and the examples in the docstrings."""

import argparse
import doctest
import importlib
import io

import pytest

from expanded_panoramas.cli import options
from expanded_panoramas.cli import progress as progress_module
from expanded_panoramas.cli.progress import Progress

CYCLES = "Fra:1 Mem:12M | Time:00:01.00 | Remaining:00:03.10 | Sample {}/{}"


def test_the_samples_of_all_view_layers_make_one_bar():
    progress = Progress()
    fractions = []
    with progress.step("rendering", samples=80):
        for done, of in ((0, 64), (32, 64), (64, 64), (0, 16), (8, 16), (16, 16)):
            progress.on_render_stats(CYCLES.format(done, of))
            progress.on_render_stats("Mem: 25M | Finished")
            fractions.append(progress._fraction)
    assert fractions == [0, 0.4, 0.8, 0.8, 0.9, 1.0]
    assert list(progress.seconds) == ["rendering"]


def test_it_shows_what_takes_long_and_removes_the_line(monkeypatch):
    monkeypatch.setattr(progress_module, "PATIENCE", 0.0)
    monkeypatch.setattr(progress_module, "_TICK", 0.01)
    stream = io.StringIO()
    progress = Progress(stream)
    with progress.step("rendering", samples=10):
        progress.on_render_stats("Sample 5/10")
        while "50 %" not in stream.getvalue():
            pass
    assert " left" in stream.getvalue()
    assert stream.getvalue().endswith(" \r")


def test_what_is_quick_is_not_shown():
    stream = io.StringIO()
    with Progress(stream).step("reading"):
        pass
    assert stream.getvalue() == ""


@pytest.mark.parametrize("text", ["", "a", "1-", "5-4", "1-9,0", "1-99999999", "1.5"])
def test_frames_that_are_none_are_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match="must be A, A-B"):
        options.frame_range(text)


@pytest.mark.parametrize("name", ["frames", "messages", "options", "progress", "render"])
def test_examples_run(name):
    results = doctest.testmod(importlib.import_module(f"expanded_panoramas.cli.{name}"))
    assert results.attempted
    assert not results.failed
