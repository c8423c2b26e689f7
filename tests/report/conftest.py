"""The page, made once for all tests that look at it."""

import pytest

from drake_leg.report.page import STAGES, write_report


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    told = []
    write_report(folder, told.append)
    assert told == list(range(1, STAGES + 1))
    return folder


@pytest.fixture(scope="session")
def page(folder):
    return (folder / "report.html").read_text(encoding="utf-8")
