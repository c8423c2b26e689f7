"""The page, made once for all tests that look at it, whichever process they run in."""

import time

import pytest

from drake_leg.lab.page.page import STAGES, write_report

PATIENCE = 600.0  # [s] with the process that makes the page


@pytest.fixture(scope="session")
def folder(tmp_path_factory, worker_id):
    base = tmp_path_factory.getbasetemp()
    shared = base if worker_id == "master" else base.parent  # of all processes of these tests
    report, scratch = shared / "report", shared / "report.part"
    try:
        (shared / "report.claimed").mkdir()
    except FileExistsError:
        _wait_for(report, shared / "report.failed")
        return report
    try:
        scratch.mkdir()
        told = []
        write_report(scratch, told.append)
        assert told == list(range(1, STAGES + 1))
        return scratch.rename(report)
    except BaseException:
        (shared / "report.failed").touch()
        raise


def _wait_for(report, failed):
    deadline = time.monotonic() + PATIENCE
    while not (report.exists() or failed.exists()) and time.monotonic() < deadline:
        time.sleep(0.5)
    assert report.exists(), "the process that makes the page did not make it"


@pytest.fixture(scope="session")
def page(folder):
    return (folder / "report.html").read_text(encoding="utf-8")
