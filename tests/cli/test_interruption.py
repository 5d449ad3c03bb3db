"""Ctrl-C, at any time: one line, exit status 130, nothing left behind."""

import os
import signal
import subprocess
import sys
import time

import pytest


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to one process")
@pytest.mark.parametrize("sign", ["started", "rendering"])
def test_it_ends_at_once_and_leaves_nothing(room, tmp_path_factory, sign):
    scratch = tmp_path_factory.mktemp("scratch")
    command = [
        "render", room / "room.json", "-o", room / "out.exr", "--camera", "panorama", "--samples", "100000",
        "--width", "1024", "--json",
    ]  # fmt: skip
    run = subprocess.Popen(
        [sys.executable, "-m", "expanded_panoramas.cli", *map(str, command)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(scratch)},
    )  # fmt: skip
    wanted = "panorama_*" if sign == "started" else "panorama_*/*"
    try:
        deadline = time.monotonic() + 60
        while not list(scratch.glob(wanted)):
            assert run.poll() is None, run.stderr.read()
            assert time.monotonic() < deadline, "it never began"
            time.sleep(0.02)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=20)
    finally:
        run.kill()
    assert (run.returncode, out) == (130, ""), err
    assert "panorama render: interrupted\n" in err
    assert "Traceback" not in err
    assert sorted(path.name for path in room.iterdir()) == ["room.exr", "room.json"]
    assert list(scratch.iterdir()) == []
