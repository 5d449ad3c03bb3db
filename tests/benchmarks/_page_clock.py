"""The phone's page drawn part by part in a headless Chromium; what processor time each part takes."""

import json
import subprocess
import tempfile
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

from web_pages import CHROMIUM, FLAGS

from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import scene_glb
from expanded_panoramas.ibl_toolkit.mobile.web_page import SOURCES

HERE = Path(__file__).parent
PAGE = """<!doctype html><canvas width="{}" height="{}"></canvas><img hidden src="/background.jpg">
<script type="importmap">{}</script><script type="module" src="/_shadow_cost.js"></script>"""
KINDS = {".js": "text/javascript", ".html": "text/html", ".jpg": "image/jpeg"}
LONGEST = 120
"""For which a part is waited [s]."""


def timed(jobs, scene, settings, background, camera):
    """Processor seconds of each job, a list: of all threads of the browser's graphics process.

    job: {light: of the scene, kind: of the settings, part: "maps" or "picture"}. They are drawn in this
    order, a picture with the maps that were drawn last.
    """
    with tempfile.TemporaryDirectory() as folder, _Server(jobs) as server:
        server.files = _files(scene, settings, background, camera)
        flags = [flag for flag in FLAGS if not flag.startswith("--virtual-time")]
        address = f"http://127.0.0.1:{server.server_port}/page.html"
        command = [CHROMIUM, *flags, "--remote-debugging-port=0", f"--user-data-dir={folder}", address]
        browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            server.answer(browser.pid)
        finally:
            browser.terminate()
            browser.wait()
    return server.seconds


class _Server(HTTPServer):
    """Gives the page its files, and one job after the other."""

    timeout = LONGEST

    def __init__(self, jobs):
        super().__init__(("127.0.0.1", 0), _Answer)
        self.jobs, self.seconds, self.files = iter(jobs), [], {}
        self.graphics = self.job = self.since = None

    def answer(self, browser):
        """All that the page asks, until the jobs are done."""
        self.browser, self.done = browser, False
        while not self.done:
            self.handle_request()

    def handle_timeout(self):
        raise TimeoutError(f"the page has asked for nothing for {LONGEST} s")

    def next_job(self):
        """The next job, or None; the one before is over."""
        self.graphics = self.graphics or _graphics_process(self.browser)
        if self.job:
            self.seconds.append(_processor_seconds(self.graphics) - self.since)
        self.job = next(self.jobs, None)
        self.done = self.job is None
        self.since = _processor_seconds(self.graphics)
        return self.job


class _Answer(BaseHTTPRequestHandler):
    def do_GET(self):
        next_ = self.path == "/next"
        body = json.dumps(self.server.next_job()).encode() if next_ else self.server.files.get(self.path)
        self.send_response(404 if body is None else 200)
        self.send_header("Content-Type", KINDS.get(Path(self.path).suffix, "application/octet-stream"))
        self.end_headers()
        self.wfile.write(body or b"")

    def log_message(self, *_):
        pass


def _files(scene, settings, background, camera):
    """{address: bytes} of what the page reads."""
    modules = {path.stem: f"/{path.name}" for path in SOURCES.glob("*.js") if path.name != "main.js"}
    own = {"programs": "/_shadow_programs.js", "programs as shipped": modules["programs"]}
    page = PAGE.format(camera.width, camera.height, json.dumps({"imports": {**modules, **own}}))
    shaders = {path.name: path.read_text(encoding="utf-8") for path in SOURCES.glob("*.glsl")}
    return {
        "/page.html": page.encode(),
        "/background.jpg": background.jpeg("a page"),
        "/scene.glb": scene_glb(scene, settings, camera, background.described()),
        "/shaders.json": json.dumps(shaders).encode(),
        **{f"/{path.name}": path.read_bytes() for path in (*SOURCES.glob("*.js"), *HERE.glob("_*.js"))},
    }


def _graphics_process(browser):
    """Its number, among a browser's descendants."""
    waiting = [browser]
    while waiting:
        process = Path("/proc", str(waiting.pop()))
        if b"--type=gpu-process" in (process / "cmdline").read_bytes():
            return process
        for thread in (process / "task").iterdir():
            waiting += (thread / "children").read_text().split()
    raise RuntimeError("the browser has no process for graphics")


def _processor_seconds(process):
    """Of all threads that a process has."""
    return sum(int((one / "schedstat").read_text().split()[0]) for one in (process / "task").iterdir()) / 1e9
