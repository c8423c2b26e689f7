"""What the rooms' tests share: seeded chance, numerical derivatives, Drake, a browser."""

import base64
import gc
import io
import math
import shutil
import time
from contextlib import contextmanager
from functools import cache
from threading import Event, Thread
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import settings

from drake_leg import progress
from drake_leg.models.plant import build_plant
from drake_leg.scene.server import Server

settings.register_profile("drake_leg", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("drake_leg")


collected = 0  # how many full collections of garbage there were
gc.disable()  # until all tests are collected


def pytest_collection_finish():
    """Modules and tests live to the end: the collector of garbage need not visit them again."""
    gc.enable()
    leave_alone()


def pytest_runtest_logfinish():
    """Nor what modules have cached since, where a test had all garbage collected."""
    if gc.get_stats()[-1]["collections"] > collected:
        leave_alone()


def leave_alone():
    global collected
    gc.collect()
    gc.freeze()
    collected = gc.get_stats()[-1]["collections"]


@pytest.fixture(autouse=True)
def quiet(monkeypatch):
    """On a busy machine anything may take ten seconds; that it does is said in test_progress."""
    monkeypatch.setattr(progress, "LINES", math.inf)


@pytest.fixture
def for_ever(monkeypatch):
    """Work without an end, which takes up any time budget as soon as it begins."""
    passed = []
    clock = SimpleNamespace(
        perf_counter=time.perf_counter, monotonic=lambda: time.monotonic() + sum(passed)
    )
    monkeypatch.setattr(progress, "time", clock)

    def work(_):
        passed.append(3600.0)
        while True:
            time.sleep(0.001)

    return work


@pytest.fixture
def rng():
    return np.random.default_rng(20231030)


@pytest.fixture(scope="session")
def derivative():
    """Central difference of fourth order of a function of one number."""

    def five_points(function, at=0.0, step=1e-3):
        near = function(at + step) - function(at - step)
        far = function(at + 2 * step) - function(at - 2 * step)
        return (8 * near - far) / (12 * step)

    return five_points


@pytest.fixture(scope="session")
def posed():
    """Drake's plant of a robot, parsed from its SDF, and a context with joint positions."""

    @cache
    def parsed(robot):
        plant = build_plant(robot)
        return plant, plant.CreateDefaultContext()

    def pose(robot, q, qdot=None):
        plant, context = parsed(robot)
        plant.SetPositions(context, q)
        plant.SetVelocities(context, np.zeros(plant.num_velocities()) if qdot is None else qdot)
        return plant, context

    return pose


@pytest.fixture(scope="session")
def drake_frames(posed):
    """Drake's poses of frame_1 ... frame_n in the world, (n, 4, 4)."""

    def poses(robot, q):
        plant, context = posed(robot, q)
        names = [f"frame_{index}" for index in range(1, len(robot.rows) + 1)]
        frames = [plant.GetFrameByName(name) for name in names]
        return np.array([frame.CalcPoseInWorld(context).GetAsMatrix4() for frame in frames])

    return poses


FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
LOCAL = ("file:", "data:", "blob:")
PATIENCE = 30.0  # [s] with a browser on a busy machine


@pytest.fixture(scope="session")
def browser():
    api = pytest.importorskip(
        "playwright.sync_api", reason="Playwright, of the extra browser, is not installed"
    )
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt-get install chromium)")
    with api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield running
        running.close()


# Resolved once ten frames in a row had nothing to draw.
CALM = """() => new Promise(done => {
  let calm = 0;
  const look = () => {
    calm = viewer.needs_render ? 0 : calm + 1;
    if (calm < 10) requestAnimationFrame(look); else done();
  };
  look();
})"""


class Visit:
    """A page in 3D that is open, with what it asked for and what it complained of."""

    def __init__(self, browser, url, size=(800, 600), **settings):
        width, height = size
        self.page = browser.new_page(viewport={"width": width, "height": height}, **settings)
        self.errors, self.requests, self.url = [], [], url
        self.page.on("console", self._note)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(url)
        self.page.wait_for_function("typeof viewer !== 'undefined' && !viewer.needs_render")
        self.calm()

    def calm(self):
        """Wait until the picture is drawn."""
        self.page.evaluate(CALM)

    def wait_until(self, holds):
        """Wait until a condition holds, however slow the machine is."""
        deadline = time.monotonic() + PATIENCE
        while not holds():
            assert time.monotonic() < deadline, f"in vain, for {PATIENCE:g} s"
            self.page.wait_for_timeout(50)

    def _note(self, message):
        if message.type == "error":
            self.errors.append(message.text)

    def frame(self, index):
        """Where the origin of a frame of the table is shown [m]."""
        node = f"viewer.scene_tree.find(['drake', 'robot', 'frame_{index}']).object"
        return np.array(self.page.evaluate(f"{node}.position.toArray()"))

    def seen(self, point):
        """Where a point of the world is in the picture: right and up, -1 ... 1."""
        x, y, z = point
        return self.page.evaluate(
            f"(v => [v.x, v.y])(new MeshCat.THREE.Vector3({x}, {z}, {-y})"
            ".project((viewer.camera.updateMatrixWorld(), viewer.camera)))"
        )

    def picture(self):
        from PIL import Image

        pixels = self.page.evaluate(
            "(viewer.render(), viewer.renderer.domElement.toDataURL('image/png'))"
        )
        image = Image.open(io.BytesIO(base64.b64decode(pixels.partition(",")[2])))
        return np.asarray(image.convert("RGB")).astype(float)

    def click(self, name):
        self.page.get_by_role("button", name=name, exact=True).click()

    def overflow(self):
        """How much wider than its window the page is, and what stands outside it [px]."""
        return self.page.evaluate(
            "[document.documentElement.scrollWidth - innerWidth,"
            " document.documentElement.scrollHeight - innerHeight,"
            " ...[...document.querySelectorAll('#page-panel button, #page-panel input,"
            " #page-panel output, #page-head')].map(e => e.getBoundingClientRect())"
            ".filter(r => r.left < 0 || r.right > innerWidth + 1 || r.bottom > innerHeight + 1)"
            ".map(r => [r.left, r.right, r.bottom])]"
        )

    def resize(self, width, height):
        self.page.set_viewport_size({"width": width, "height": height})
        self.page.wait_for_function(f"innerWidth === {width} && innerHeight === {height}")
        self.calm()

    def put_back(self):
        """Look as at first, with all that can be seen, a replay at its start."""
        self.check()
        for hidden in self.page.locator("#page-shown [aria-pressed=false]").all():
            hidden.click()
        self.click("3D")
        self.page.evaluate("document.activeElement.blur()")
        self.page.keyboard.press("Home")
        self.calm()

    def close(self):
        self.page.close()
        self.check()

    def check(self):
        """No error so far, and no request elsewhere."""
        assert self.errors == []
        assert [url for url in self.requests if not url.startswith((*LOCAL, self.url))] == []


@contextmanager
def opening(browser):
    visits = []

    def visit(url, **settings):
        visits.append(Visit(browser, url, **settings))
        return visits[-1]

    yield visit
    for one in visits:
        one.close()


@pytest.fixture
def open_page(browser):
    """Open pages; they are closed at the end, without an error and without a request elsewhere."""
    with opening(browser) as visit:
        yield visit


@pytest.fixture(scope="module")
def keep_page(browser):
    """Open pages, each once for all tests of a module, which put them back to their start."""
    with opening(browser) as visit:
        yield cache(visit)


@contextmanager
def serving():
    over, loops = Event(), []

    def pause(seconds):
        if over.wait(seconds):
            raise KeyboardInterrupt

    def run(server, session, *arguments, **keywords):
        with server:
            session(*arguments, server, **keywords, wait=pause)

    def start(*arguments, **keywords):
        server = Server()
        loops.append(Thread(target=run, args=(server, *arguments), kwargs=keywords, daemon=True))
        loops[-1].start()
        return server

    yield start
    over.set()
    for loop in loops:
        loop.join(5.0)
        assert not loop.is_alive()


@pytest.fixture
def served():
    """Carry out a session with a server of its own, interrupted when the test ends."""
    with serving() as start:
        yield start


@pytest.fixture(scope="module")
def kept_served():
    """Carry out a session for all tests of a module."""
    with serving() as start:
        yield start
