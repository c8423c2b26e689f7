"""Random robots of one to eight joints through every command, each answer checked.

A command may refuse a robot, by one sentence and a documented status, or do what it says; it never
leaves a traceback, half a file, or something that is not so.
"""

import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from campaigns import cases
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from random_robots import random_robot

from drake_leg.cli import main
from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.feet import greatest_reach, random_configurations
from drake_leg.models.proof import DrakeWitness
from drake_leg.robot.robot_file import load_robot
from drake_leg.scene.driven_foot import DrivenFoot
from drake_leg.simulation.recording import Recording

# Work that is stopped at its budget may be in a weak reference's callback, which is only reported.
UNRAISABLE = "ignore::pytest.PytestUnraisableExceptionWarning"
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings(UNRAISABLE)]

ROBOTS = cases(24)
MODEL = str(Path(__file__).parents[2] / "notebooks" / "leg.slx")


@pytest.fixture(params=range(ROBOTS))
def subject(request, tmp_path, monkeypatch, capsys):
    return Subject(request.param, tmp_path, monkeypatch, capsys)


class Subject:
    """A random robot, and what the commands say of it."""

    def __init__(self, seed, folder, monkeypatch, capsys):
        rng = np.random.default_rng(seed)
        self.seed, self.folder, self._capsys = seed, folder, capsys
        monkeypatch.chdir(folder)
        monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())
        text, self.count = random_robot(seed, rng)
        self.file = f"chance_{seed}.toml"
        (folder / self.file).write_text(text, encoding="utf-8")
        self.robot = load_robot(folder / self.file)
        self.witness = DrakeWitness(self.robot)
        self.size = greatest_reach(self.robot)
        self.q = random_configurations(self.robot, 1, rng)[0]
        turning = [segment.row.joint == "revolute" for segment in self.robot.moving]
        typed = np.where(turning, np.degrees(self.q), self.q)
        self.typed = ",".join(f"{value:.9f}" for value in typed)
        rounded = np.array([float(value) for value in self.typed.split(",")])
        self.q = np.where(turning, np.radians(rounded), rounded)
        self.turning = turning

    def __call__(self, *words, makes=None):
        """Run a command: status and standard output, after what must hold of every answer."""
        there = {path.name for path in self.folder.iterdir()}
        try:
            status = main([str(word) for word in words])
        except SystemExit as stop:
            status = stop.code
        printed = self._capsys.readouterr()
        assert status in (0, 1, 2, 3), words
        assert "Traceback" not in printed.err, words
        made = {path.name for path in self.folder.iterdir()} - there
        if status == 2:
            assert printed.err.startswith("drake-leg: "), words
            assert printed.err.count("\n") == 1, (words, printed.err)
            assert made == set(), (words, made)
        else:
            assert made <= {makes}, (words, made)
        if status == 0 and makes is not None:
            assert made == {makes}, words
        return status, printed.out

    def radians(self, typed):
        return np.where(self.turning, np.radians(typed), typed)


def test_the_robot_through_every_command(subject):
    sdf(subject)
    doctor(subject)
    teleop(subject)
    if subject.seed % 2 == 0:
        diagrams(subject)
    if subject.seed % 4 == 0:
        inverse_kinematics(subject)
    if subject.count <= 3 and subject.seed % 3 == 0:
        check(subject)
    if subject.count >= 7 and subject.seed % 4 == 3:
        check_in_part(subject)
    if subject.count <= 2:
        derivation(subject)
    if subject.seed % 6 == 1:
        still(subject)
    if subject.count == 3 or subject.seed % 5 == 1:
        run_and_replay(subject)
    if subject.seed % 6 == 3:
        compare_and_inspect(subject)


def sdf(subject):
    status, _ = subject("sdf", subject.file, "--out", "arm.sdf", makes="arm.sdf")
    assert status == 0
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.AddModels(str(subject.folder / "arm.sdf"))
    plant.Finalize()
    assert plant.num_positions() == subject.count
    status, _ = subject("sdf", subject.file, "--toml", "--out", "again.toml", makes="again.toml")
    assert status == 0
    again = load_robot(subject.folder / "again.toml")
    np.testing.assert_allclose(
        DrakeWitness(again).foot(subject.q), subject.witness.foot(subject.q), atol=1e-12
    )


def doctor(subject):
    assert subject("doctor", subject.file)[0] == 2
    if subject.seed % 5 == 4:
        words = ("--q", subject.typed, "--direction", "0,1,0", "--frequency", "2")
        status, text = subject("doctor", subject.file, *words)
        assert status == 0
        assert text.startswith("foot ")
    status, out = subject("doctor", subject.file, "--q", subject.typed, "--json")
    assert status == 0
    said = json.loads(out)
    X_BF, J = subject.witness.foot(subject.q), subject.witness.jacobian(subject.q)
    height = said["foot_m"][2]
    np.testing.assert_allclose(said["foot_m"][:2], X_BF[:2, 3], atol=1e-9 * subject.size)
    assert height is None or height == pytest.approx(X_BF[2, 3], abs=1e-9 * subject.size)
    if said["full_rank"] == min(3, subject.count):
        sigma = np.linalg.svd(J[3:], compute_uv=False)
        assert said["rank"] == (sigma > 1e-9 * max(sigma[0], 1e-6 * subject.size)).sum()
        assert said["sigma_min_m"] == pytest.approx(sigma[-1], abs=1e-9 * subject.size)
    assert said["outside_limits"] == []
    for way in (said["stroke_forward_m"], said["stroke_backward_m"]):
        assert way is None or way >= 0.0


def inverse_kinematics(subject):
    X_BF = subject.witness.foot(subject.q)
    foot = ",".join(f"{value:.12g}" for value in X_BF[:3, 3])
    status, out = subject("doctor", subject.file, "--foot", foot, "--json")
    if status == 2:
        status, out = subject(
            "doctor", subject.file, "--q", subject.typed, "--foot", foot, "--json"
        )
    assert status == 0
    said = json.loads(out)
    branches = [branch.get("q", branch.get("q_deg")) for branch in said["branches"]]
    found = [subject.radians(q) for q in branches if q is not None]
    assert found, said["branches_heading"]
    for q in found:
        np.testing.assert_allclose(
            subject.witness.foot(q)[:3, 3], X_BF[:3, 3], atol=1e-8 * subject.size
        )
    within = [branch for branch in said["branches"] if branch["within_limits"]]
    assert within, said
    if "infinitely" not in said["branches_heading"]:
        turns = [
            np.where(subject.turning, np.remainder(q - subject.q + 3.0, 2.0 * math.pi) - 3.0,
                     q - subject.q)
            for q in found
        ]  # fmt: skip
        assert min(np.abs(turn).max() for turn in turns) < 1e-4, said


def diagrams(subject):
    parts = ("all", "signals", "mechanism", "frames", "link_1")
    for part in parts if subject.seed % 20 == 4 else (parts[subject.seed // 2 % len(parts)],):
        status, _ = subject(
            "diagram", subject.file, "--part", part, "--out", f"{part}.svg", makes=f"{part}.svg"
        )
        assert status in (0, 2)
        if status == 0:
            assert ET.parse(subject.folder / f"{part}.svg").getroot().tag.endswith("svg")


def teleop(subject):
    """Drive the foot by the session's logic, without a server."""
    velocity, dt = np.array([0.01, -0.02, 0.015]), 1.0 / 30.0
    try:
        drive = DrivenFoot(subject.robot)
        start = drive.at_rest(subject.q)
        step = drive.step(start.q, velocity, dt)
    except DrakeLegError:
        return
    before, after = (subject.witness.foot(one.q)[:3, 3] for one in (start, step))
    np.testing.assert_allclose(step.foot, after, atol=1e-9 * subject.size)
    if step.share is not None and step.state == "free" and not drive.moved.varies:
        wanted = drive.moved.twists[3:] @ drive.moved.command(velocity)
        np.testing.assert_allclose(after - before, wanted * dt, atol=1e-4 * dt)


def check(subject):
    status, out = subject("check", subject.file, "--samples", "3", "--json")
    said = json.loads(out)
    assert (status, said["proof"]["holds"], said["proof"]["complete"]) == (0, True, True), said
    links = [segment.link for segment in subject.robot.segments if segment.link]
    weighs = any(link.solid or link.inertial for link in links)
    assert {comparison["quantity"] for comparison in said["proof"]["comparisons"]} == {
        "foot",
        "Jacobian",
        *(["torques"] if weighs else []),
    }


def check_in_part(subject):
    status, out = subject("check", subject.file, "--samples", "2", "--budget", "1.5", "--json")
    said = json.loads(out)
    assert said["proof"]["holds"]
    assert status == (0 if said["proof"]["complete"] else 3)
    assert said["ok"] == said["proof"]["complete"]


def derivation(subject):
    status, out = subject("derive", subject.file, "--latex", "--budget", "4")
    assert status in (0, 3)
    if status == 0:
        assert "direct - indirect = 0" in out


def still(subject):
    status, _ = subject(
        "view", subject.file, "--q", subject.typed, "--still", "a.png", makes="a.png"
    )
    assert status == 0
    assert (subject.folder / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def run_and_replay(subject):
    words = ("--q0", subject.typed, "--amplitude", "0.01", "--duration", "0.2")
    status, _ = subject("run", subject.file, "--out", "run", *words, makes="run")
    if status != 0:
        assert status in (2, 3)
        return
    summary = json.loads((subject.folder / "run" / "summary.json").read_text(encoding="utf-8"))
    recording = Recording.read_csv(subject.folder / "run" / "recording.csv")
    joints = np.column_stack([recording[f"q{i}"] for i in range(1, subject.count + 1)])
    feet = np.array([subject.witness.foot(q)[:3, 3] for q in joints])
    way = 0.01 * (1.0 - np.cos(recording["time"]))
    moved = feet - feet[0]
    along = moved @ np.array(summary["direction"])
    error = summary["max_position_error_m"]
    np.testing.assert_allclose(along, way, atol=error + 1e-9)
    assert np.abs(np.linalg.norm(moved, axis=1) - way).max() < error + 1e-9
    status, _ = subject(
        "replay", "run", "--robot", subject.file, "--out", "run.html", makes="run.html"
    )
    assert status == 0
    assert "</html>" in (subject.folder / "run.html").read_text(encoding="utf-8")


def compare_and_inspect(subject):
    status, _ = subject("compare", MODEL, subject.file)
    assert status != 0, "no random robot is the leg of the model"
    assert subject("inspect", subject.file)[0] == 2
