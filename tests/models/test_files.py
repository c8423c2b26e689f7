"""The folder of SDF files: up to date, and found from a checkout and from a wheel."""

import os
import runpy
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from drake_leg.models import plant
from drake_leg.models.plant import generated_files, sdf_folder
from drake_leg.robot.robots import ROBOTS

PROJECT = Path(__file__).parents[2]
COMMITTED = PROJECT / "sdf"


@pytest.mark.parametrize("name", generated_files())
def test_a_committed_file_is_what_the_robots_data_say(name):
    assert (COMMITTED / name).read_bytes() == generated_files()[name].encode()


def test_the_folder_holds_the_generated_files_and_nothing_else():
    assert {path.name for path in COMMITTED.iterdir()} == set(generated_files())


def test_the_module_writes_the_files(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["files", str(tmp_path)])
    runpy.run_path(plant.__file__, run_name="__main__")
    written = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert written == generated_files()


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_every_robots_file_is_found(robot):
    assert (sdf_folder() / f"{robot.name}.sdf").is_file()


def folder_seen_by(path, cwd):
    """Ask a fresh interpreter, with ``path`` before everything installed, for the folder."""
    question = (
        "import drake_leg.models.plant as f; print(f.__file__); print(f.sdf_folder()); "
        "print(*sorted(p.name for p in f.sdf_folder().iterdir()))"
    )
    environment = {**os.environ, "PYTHONPATH": str(path)}
    command = [sys.executable, "-W", "error", "-c", question]
    answer = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=True
    )
    module, folder, names = answer.stdout.splitlines()
    return Path(module), Path(folder), set(names.split())


@pytest.mark.slow
def test_a_checkout_finds_its_own_folder(tmp_path):
    module, folder, names = folder_seen_by(PROJECT, tmp_path)
    assert module.is_relative_to(PROJECT)
    assert folder == COMMITTED
    assert names == set(generated_files())


@pytest.mark.slow
def test_a_wheel_carries_the_folder_and_finds_it(tmp_path):
    pytest.importorskip("pip", reason="2026-11-22: uv's environments have no pip to build with")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check"]
    subprocess.run(
        [*build, "--no-deps", str(PROJECT), "-w", str(tmp_path)], check=True, capture_output=True
    )
    (wheel,) = tmp_path.glob("drake_leg-*.whl")
    installed = tmp_path / "installed"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    module, folder, names = folder_seen_by(installed, tmp_path)
    assert module.is_relative_to(installed)
    assert folder == installed / "drake_leg" / "sdf"
    assert names == set(generated_files())
    for name, text in generated_files().items():
        assert (folder / name).read_bytes() == text.encode()
