"""The page's stages are the same by one process and by several, and none outlives its parent."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time

import pytest

from drake_leg.lab.page import page
from drake_leg.lab.page.contents import chapters
from drake_leg.lab.page.items import KINDS, ShownItem
from drake_leg.lab.page.workers import working
from drake_leg.scene import artists

RUNS = {name: page.RUNS[name] for name in ("pendulum", "leg-b", "hexapod")}


def one_of_each_kind():
    """The first item of each kind whose run is one of these, or which shows none."""
    found = {}
    for item in (item for chapter in chapters() for item in chapter.items):
        if item.kind not in page.OF_RUNS or item.subject in RUNS:
            found.setdefault(item.kind, item)
    assert found.keys() == KINDS.keys()
    return tuple(found.values())


@pytest.fixture
def few(monkeypatch):
    """Few runs and items; what a trial of VTK told this process, which one here kills, is left."""
    monkeypatch.setattr(artists, "_TOLD", [])
    artists.rendering_fault.cache_clear()
    monkeypatch.setattr(page, "RUNS", RUNS)
    monkeypatch.setattr(page, "ITEMS", one_of_each_kind())
    yield
    artists.rendering_fault.cache_clear()


def stages(folder, workers):
    """Make all stages; check that there is one of each, and return the items."""
    folder.mkdir()
    made = list(page._stages(folder, workers))
    assert sorted(str(what) for what, _ in made) == sorted(map(str, (*RUNS, *page.ITEMS)))
    return {what.id: result for what, result in made if isinstance(result, ShownItem)}


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.slow
def test_workers_make_the_same_items_and_the_same_files(few, tmp_path):
    alone, shared = (stages(tmp_path / f"{count}", count) for count in (1, 2))
    assert alone == shared
    assert len(alone) == len(page.ITEMS)
    assert files(tmp_path / "1") == files(tmp_path / "2")
    assert multiprocessing.active_children() == []


@pytest.mark.slow
def test_a_worker_that_is_lost_costs_no_item(few, tmp_path, monkeypatch):
    """Be it one that shows a run, one that a process draws alone, or mathematics."""
    monkeypatch.setattr(page, "RUNS", {"pendulum": RUNS["pendulum"]})
    (plot,) = (i for i in page.ITEMS if i.kind == "plot")
    others = {i.kind in page.ALONE: i for i in page.ITEMS if i.kind not in page.OF_RUNS}
    monkeypatch.setattr(page, "ITEMS", (plot, *others.values()))
    made = []
    for what, result in page._stages(tmp_path, 2):
        if not made:
            multiprocessing.active_children()[0].kill()
        made.append((what, result))
    assert sorted(str(what) for what, _ in made) == sorted(map(str, ("pendulum", *page.ITEMS)))
    assert sum(isinstance(result, ShownItem) for _, result in made) == len(page.ITEMS)


def test_workers_are_stopped_at_once_where_the_work_is_interrupted():
    def interrupted():
        with working(1) as workers:
            workers.submit(time.sleep, 3600.0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert multiprocessing.active_children() == []


SCRIPT = """
import math
from drake_leg.lab.page.workers import working
from drake_leg.scene import artists
print("the script")
with working(1) as workers:
    print(workers.submit(math.sqrt, 4.0).result())
"""


@pytest.mark.slow
def test_a_script_needs_no_guard(tmp_path):
    """Python would run it again in every worker, and fail."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("the script\n2.0\n", "")


ORPHAN = """
import os, sys
from drake_leg.lab.page.workers import working
from drake_leg.scene import artists
with working(1) as workers:
    print(workers.submit(os.getpid).result(), flush=True)
    sys.stdin.read()
"""


def is_alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_worker_ends_with_a_parent_that_is_killed():
    parent = subprocess.Popen(
        [sys.executable, "-c", ORPHAN],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    worker = int(parent.stdout.readline())
    parent.kill()
    parent.communicate()
    deadline = time.monotonic() + 60.0
    while is_alive(worker) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not is_alive(worker)


@pytest.mark.slow
def test_a_report_that_is_interrupted_leaves_no_file_and_one_sentence(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "drake_leg", "report", "--out", "report"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    for line in process.stderr:
        if "stages, at work" in line:
            os.killpg(process.pid, signal.SIGINT)  # as a terminal does
            break
    _, err = process.communicate(timeout=120)
    assert process.returncode == 130
    rest = [line for line in err.splitlines() if "at work" not in line]
    assert rest == ["drake-leg: interrupted"]
    assert list(tmp_path.iterdir()) == []
