"""Random runs within limits: no joint leaves them, and what is said of the foot is so."""

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import cases

from drake_leg.errors import DrakeLegError
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import hexabot_leg
from drake_leg.robot.toml.reader import read_robot
from drake_leg.runs.options import StraightOptions
from drake_leg.runs.step import run as run_robot
from drake_leg.singularity.forecast import Forecast
from drake_leg.singularity.inverse import MARGIN
from drake_leg.units import AT_LIMIT

RUNS = cases(60)
BATCHES = 4
NARROWEST = 0.01  # [rad or m], of the way between two limits
NEARLY_SINGULAR = 0.01  # [m], smallest singular value of a run that passes a singularity
PASSING = 1.5  # of a greatest rate, where rates turn round within milliseconds
OFF = 1e-6  # [m], as in the summary

ROW = """
[[row]]
sigma = {sigma}
d = {d}
alpha = {alpha}
r = {r}
theta = {theta}
[row.solid]
shape = "brick"
length = 0.1
width = 0.02
height = 0.02
density = 1000
"""


def of_rows(*rows, tool):
    """Make a robot of rows (sigma, d, alpha, r, theta) and a tool's length, by its file."""
    text = 'name = "random"\nangles = "deg"\n'
    for sigma, d, alpha, r, theta in rows:
        text += ROW.format(sigma=sigma, d=d, alpha=alpha, r=r, theta=theta)
    return read_robot(f'{text}[[row]]\nsigma = "~"\nd = {tool}\nalpha = 0\nr = 0\ntheta = 0\n', "r")


def random_robot(rng):
    kind = rng.choice(
        ["leg", "leg", "leg", "leg", "leg", "leg", "leg", "arm", "cylindric", "gantry"]
    )
    a, b, c = rng.uniform(0.05, 0.4, 3).round(3).tolist()
    if kind == "leg":
        return hexabot_leg(str(rng.choice(["A", "B"])))
    if kind == "arm":
        return of_rows((0, 0, 0, a, 0), (0, 0, 90, 0, 0), (0, b, 0, 0, 0), tool=c)
    if kind == "cylindric":
        return of_rows((0, 0, 0, a, 0), (1, 0, 0, b, 0), (1, 0, 90, c, 0), tool=0)
    return of_rows((1, 0, 0, 0, 0), (1, 0, 90, 0, 90), (1, 0, 90, 0, 0), tool=0)


def random_posture(robot, rng):
    widest = [math.pi if s.row.joint == "revolute" else 0.1 for s in robot.moving]
    return (np.array(widest) * rng.uniform(-1.0, 1.0, len(widest))).tolist()


def random_limits(robot, q0, rng):
    """Give joints limits near their posture: on none, one or both sides, or at it."""
    segments = []
    for segment, q in zip(robot.moving, q0, strict=True):
        below, above = rng.choice([0.0, 1e-4, 0.01, 0.05, 0.2, 1.0, math.inf], 2).tolist()
        if below + above < NARROWEST:
            below = 0.3
        velocity = rng.choice([None, 0.2, 1.0, 3.0])
        mechanics = JointMechanics(
            lower=None if math.isinf(below) else q - below,
            upper=None if math.isinf(above) else q + above,
            velocity=velocity,
        )
        segments.append(replace(segment, mechanics=mechanics))
    fixed = tuple(segment for segment in robot.segments if segment.row.joint == "fixed")
    return replace(robot, segments=(*segments, *fixed))


def given(robot, q):
    """Write joint positions as the options take them."""
    return [
        math.degrees(value) if segment.row.joint == "revolute" else value
        for segment, value in zip(robot.moving, q, strict=True)
    ]


def random_case(seed):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng)
    q0 = random_posture(robot, rng)
    robot = random_limits(robot, q0, rng)
    rate_limit = rng.choice([None, 20.0, 120.0, 300.0])
    errs, pushed = rng.random() < 0.2, rng.random() < 0.1
    options = StraightOptions(
        q0=given(robot, q0),
        amplitude=float(rng.uniform(-0.6, 0.6)),
        frequency=float(rng.uniform(2.0, 7.0)),
        direction=rng.normal(size=3).tolist(),
        duration=0.25,
        max_step=0.01,
        inverse="limited",
        rate_limit=rate_limit if any(s.row.joint == "revolute" for s in robot.moving) else None,
        correction=rng.choice([None, 0.0, 2.0, 20.0]),
        q0_error=given(robot, rng.normal(size=3) * 0.02 * errs),
        push=(rng.normal(size=3) * 0.2).tolist() if pushed else None,
        push_at=0.1 if pushed else None,
        feedback=str(rng.choice(["sensed", "sensed", "integrated"])),
    )
    return robot, q0, options


def faults_of_joints(robot, options, outcome):
    """List where a joint left its limits or was too fast."""
    for number, segment in enumerate(robot.moving, start=1):
        q, qdot = outcome.recording[f"q{number}"], outcome.recording[f"qdot{number}"]
        low, high = segment.mechanics.bounds
        near = min(q[0] - low, high - q[0]) < MARGIN
        beyond = max(low - q.min(), q.max() - high)
        if beyond > (AT_LIMIT if near else 0.0):
            yield f"joint {number} is beyond {beyond:.3g}"
        most = segment.mechanics.velocity or 2.0 * math.pi
        if segment.row.joint == "revolute" and options.rate_limit is not None:
            most = math.radians(options.rate_limit)
        through = outcome.summary["sigma_min_m"] < NEARLY_SINGULAR
        if np.abs(qdot).max() > (PASSING if through else 1.0) * most:
            yield f"joint {number} goes {np.abs(qdot).max():.6g}, and may go {most:.6g}"


def faults_of_foot(robot, q0, options, outcome):
    """List what the summary says of the foot and the recording does not."""
    recording, summary = outcome.recording, outcome.summary
    feet = recording.stack("x", "y", "z")
    along = np.array(options.direction) / np.linalg.norm(options.direction)
    way = options.amplitude / options.frequency
    went = way * (1.0 - np.cos(options.frequency * recording["time"]))
    off = np.linalg.norm(feet - foot_pose(robot.rows, q0)[:3, 3] - np.outer(went, along), axis=1)
    reached = foot_pose(robot.rows, recording.stack("q1", "q2", "q3"))[:, :3, 3]
    time_off = np.diff(recording["time"])[off[1:] > OFF].sum()
    for what, found, said in (
        ("foot", np.abs(reached - feet).max(), 0.0),
        ("greatest distance", off.max(), summary["greatest_distance_from_command_m"]),
        ("last distance", off[-1], summary["distance_from_command_at_the_end_m"]),
        ("time off", time_off, summary["time_off_command_s"]),
    ):
        if not abs(found - said) < 1e-9:
            yield f"{what} is {found:.6g}, and {said:.6g} is said"


def faults(seed):
    robot, q0, options = random_case(seed)
    try:
        outcome = run_robot(robot, options)
    except DrakeLegError as error:
        begins_outside = any(options.q0_error) and "outside its limits" in str(error)
        return [] if begins_outside else [str(error)]
    found = list(faults_of_foot(robot, q0, options, outcome))
    reason = outcome.summary["stop_reason"]
    if options.push:
        return found if reason is None or "a weaker disturbance" in reason else [*found, reason]
    return [*found, *faults_of_joints(robot, options, outcome), *filter(None, [reason])]


@pytest.fixture
def nothing_foreseen(monkeypatch):
    """Leave out what lies ahead, which takes longer than these short runs."""
    monkeypatch.setattr("drake_leg.runs.step.foresee", lambda *_, **__: Forecast())


@pytest.mark.slow
@pytest.mark.usefixtures("nothing_foreseen")
@pytest.mark.parametrize("batch", range(BATCHES))
def test_within_limits_no_joint_leaves_them_and_the_foot_is_told_truly(batch):
    found = {seed: faults(seed) for seed in range(batch, RUNS, BATCHES)}
    assert not {seed: said for seed, said in found.items() if said}
