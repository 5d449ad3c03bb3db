"""The zip without wheels in a real Blender: it installs, and its command answers."""

import os
import shlex
import subprocess

import build_zips
import pytest

BLENDER = os.environ.get("BLENDER")

pytestmark = pytest.mark.skipif(not BLENDER, reason="needs BLENDER=/path/to/blender ./run test")


def blender(user_folder, *command):
    return subprocess.run(
        [*shlex.split(BLENDER), "--background", "--command", *command],
        capture_output=True,
        text=True,
        env={**os.environ, "BLENDER_USER_RESOURCES": str(user_folder)},
    )


def test_zip_installs_and_the_command_answers(tmp_path):
    target = tmp_path / "plain.zip"
    build_zips.build(build_zips.ROOT, target)
    user = tmp_path / "user"
    installed = blender(user, "extension", "install-file", "-r", "user_default", "--enable", str(target))
    assert installed.returncode == 0, installed.stderr
    helped = blender(user, "panorama", "--help")
    assert (helped.returncode, "usage: panorama" in helped.stdout) == (0, True), helped.stderr
    refused = blender(user, "panorama", "no-such-verb")
    assert refused.returncode == 2
    assert "no-such-verb" in refused.stderr
