"""Tests that click in a real Blender's window: each module plays its jobs in one window and reads its notes.

    BLENDER=/path/to/blender python -m pytest tests/gui --pictures docs/images/manual

also writes the manual's pictures. Blender's own file is never touched: it gets a user folder of its own.
"""

import os
import pathlib
import re

import build_zips
import pytest

from .window import Display, NoWindowError, crop, install, play

BLENDER = os.environ.get("BLENDER")


def pytest_addoption(parser):
    parser.addoption("--pictures", type=pathlib.Path, help="folder for the manual's pictures (tests/gui)")


@pytest.fixture(scope="session")
def display(tmp_path_factory):
    """A display of its own."""
    if not BLENDER:
        pytest.skip("needs a Blender with a window: BLENDER=/path/to/blender")
    try:
        here = Display(tmp_path_factory.mktemp("display"))
    except NoWindowError as reason:
        pytest.skip(str(reason))
    yield here
    here.end()


@pytest.fixture(scope="session")
def user(display, tmp_path_factory):
    """A user folder in which the extension is installed."""
    folder = tmp_path_factory.mktemp("blender_user")
    install(BLENDER, folder)
    return folder


class Played(dict):
    """What the jobs of a module noted: played[name of the job] -> {what: value}; fails where the job did."""

    def __getitem__(self, name):
        found = super().__getitem__(name)
        assert "error" not in found, f"{name}: {found['error']}"
        return found


def manual_pictures():
    """Names of the pictures that the manual shows."""
    pages = [page.read_text("utf-8") for page in (build_zips.ROOT / "docs" / "manual").glob("*.md")]
    return set(re.findall(r"images/manual/(\w+)\.jpg", "".join(pages)))


@pytest.fixture(scope="module")
def notes(request, display, user, tmp_path_factory):
    """What the jobs of the module's JOBS noted."""
    folder = tmp_path_factory.mktemp(request.module.JOBS.removesuffix(".py"))
    try:
        played = play(BLENDER, user, display, request.module.JOBS, folder)
    except NoWindowError as reason:
        pytest.skip(str(reason))
    pictures = request.config.getoption("--pictures", default=None)
    if pictures:
        for name in manual_pictures() & played["pictures"].keys():
            crop(folder / f"{name}.png", pictures / f"{name}.jpg", played["pictures"][name])
    if not any("error" in job for job in played["jobs"].values()):
        assert "Traceback" not in played["printed"], played["printed"]  # of a panel or a draw callback
    return Played(played["jobs"])
