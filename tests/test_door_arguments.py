"""Wrong arguments to the front door's robots, motions and examinations, each refused in words."""

import math

import numpy as np
import pytest

import drake_leg as dl
from drake_leg.errors import InvalidValueError

Q = [1.57, -0.87, -1.57]
NOT_A_NUMBER = math.nan


def robot(**changes):
    return dl.Robot(
        **{"name": "arm", "title": "Arm", "source": "here", "segments": dl.LEG_B.segments} | changes
    )


def examine(q=Q, of=None, **more):
    return dl.examine_posture(of or dl.LEG_B, q, **more)


CALLS = {
    "Robot, a number for a segment": (lambda: robot(segments=[1]), "segment 1 of a robot is 1"),
    "Robot, no segments": (lambda: robot(segments=None), "segments of a robot is None"),
    "Robot, empty": (lambda: robot(segments=()), "no row that moves"),
    "Robot, name": (lambda: robot(name=3), "the robot's name is 3"),
    "Robot, title": (lambda: robot(title=None), "the robot's title is None"),
    "Robot, source": (lambda: robot(source=b"here"), "the robot's source is b'here'"),
    "SineStep, amplitude": (lambda: dl.SineStep(amplitude="x"), "the amplitude is 'x'"),
    "SineStep, no amplitude": (lambda: dl.SineStep(amplitude=None), "the amplitude is None"),
    "SineStep, nan": (lambda: dl.SineStep(amplitude=NOT_A_NUMBER), "amplitude is nan m/s"),
    "SineStep, frequency": (lambda: dl.SineStep(frequency=[1.0]), r"the frequency is \[1.0\]"),
    "SineStep, direction": (lambda: dl.SineStep(direction="xyz"), "the direction is 'xyz'"),
    "SineStep, two": (lambda: dl.SineStep(direction=(1.0, 0.0)), "must be three finite numbers"),
    "SineStep, one": (lambda: dl.SineStep(direction=1.0), "must be three finite numbers"),
    "SineStep, none": (lambda: dl.SineStep(direction=None), "the direction is None"),
    "SineStep, nan along": (
        lambda: dl.SineStep(direction=(NOT_A_NUMBER, 0.0, 0.0)),
        "must be three finite numbers",
    ),
    "SineStep, huge": (lambda: dl.SineStep(amplitude=10**400), "too large for a float"),
    "SineStep, huge along": (
        lambda: dl.SineStep(direction=(10**400, 0, 0)),
        "the direction is a tuple; it must be three finite numbers",
    ),
    "EllipticStep, lift": (lambda: dl.EllipticStep(lift="x"), "the lift is 'x'"),
    "EllipticStep, no lift": (lambda: dl.EllipticStep(lift=None), "the lift is None"),
    "EllipticStep, nan": (lambda: dl.EllipticStep(lift=NOT_A_NUMBER), "lift is nan m"),
    "EllipticStep, direction": (lambda: dl.EllipticStep(direction=[1]), "three finite numbers"),
    "EllipticStep, amplitude": (lambda: dl.EllipticStep(amplitude={}), "the amplitude is {}"),
    "load_robot, number": (lambda: dl.load_robot(3), "the path of a robot file is 3"),
    "load_robot, nothing": (lambda: dl.load_robot(None), "the path of a robot file is None"),
    "load_robot, no file": (lambda: dl.load_robot("no such file"), "cannot be read"),
    "load_robot, null": (lambda: dl.load_robot("a\0b"), "cannot be read"),
    "Recording, number": (lambda: dl.Recording(3), "columns of a recording is 3; it must be a Map"),
    "Recording, header": (lambda: dl.Recording({1: [2.0]}), "the header of a column is 1"),
    "Recording, text": (lambda: dl.Recording({"a": ["x"]}), r"a is \['x'\]; it must be real"),
    "Recording, flat": (lambda: dl.Recording({"a": 1.0}), r"the column a has shape \(\)"),
    "errata, text": (lambda: dl.errata("1"), "an erratum is '1'; it must be a whole number"),
    "errata, list": (lambda: dl.errata([1]), r"an erratum is \[1\]; it must be a whole number"),
    "report, number": (lambda: dl.report(3), "folder is 3; it must be a str or Path"),
    "report, progress": (lambda: dl.report("r", progress=3), "progress is 3; it must be a funct"),
    "write_video, progress": (
        lambda: dl.write_video("a.gif", dl.PENDULUM, ([0.0], [[0.0]]), progress=3),
        "progress is 3; it must be a function",
    ),
    "view, announce": (lambda: dl.view(dl.LEG_B, announce=3), "announce is 3; it must be a func"),
    "movable, huge": (lambda: dl.movable(dl.LEG_B, [10**400, 0, 0]), "it must be real numbers"),
    "movable, nothing": (lambda: dl.movable(None), "None is not a Robot"),
    "movable, word": (lambda: dl.movable(dl.LEG_B, "x"), "q0 is 'x'; it must be real numbers"),
    "movable, one": (lambda: dl.movable(dl.LEG_B, 1.0), "q0 is 1.0; it must be 3 joint positions"),
    "movable, two": (lambda: dl.movable(dl.LEG_B, Q[:2]), "q0 has 2 numbers; leg_b has 3"),
    "movable, nan": (lambda: dl.movable(dl.LEG_B, [NOT_A_NUMBER] * 3), "not finite"),
    "movable, a batch": (lambda: dl.movable(dl.LEG_B, [Q, Q]), "it must be 3 joint positions"),
    "movable, task": (lambda: dl.movable(dl.LEG_B, task=["pose"]), "position or pose"),
    "examine_posture, nothing": (lambda: dl.examine_posture(None, Q), "None is not a Robot"),
    "examine_posture, word": (lambda: examine("x"), "q is 'x'; it must be real numbers"),
    "examine_posture, none": (lambda: examine(None), "q is None; it must be 3 joint positions"),
    "examine_posture, two": (lambda: examine(Q[:2]), "q has 2 numbers; leg_b has 3"),
    "examine_posture, SCARA": (lambda: examine(Q[:2], dl.SCARA), "q has 2 numbers; scara has 4"),
    "examine_posture, five": (lambda: examine([0.0] * 5, dl.SCARA), "q has 5 numbers"),
    "examine_posture, nan": (lambda: examine([*Q[:2], NOT_A_NUMBER]), "not finite"),
    "examine_posture, ragged": (lambda: examine([Q, 1.0]), "it must be real numbers"),
    "examine_posture, complex": (lambda: examine([1j, 0.0, 0.0]), "it must be real numbers"),
    "examine_posture, direction": (lambda: examine(direction="x"), "the direction is 'x'"),
    "examine_posture, flat": (lambda: examine(direction=(1.0, 0.0)), "must be 3 long"),
    "examine_posture, nowhere": (lambda: examine(direction=(0, 0, 0)), "the direction is zero"),
    "examine_posture, singular": (
        lambda: examine([0.0, 0.0, 0.0], direction=(0, 0, 0)),
        "the direction is zero",
    ),
    "examine_posture, frequency": (
        lambda: examine(frequency="x", direction=(1, 0, 0)),
        "the frequency is 'x'",
    ),
    "examine_posture, no direction": (lambda: examine(frequency=2.0), "give `direction`, too"),
    "examine_posture, foot": (lambda: examine(foot="x"), "the foot is 'x'"),
    "examine_posture, flat foot": (lambda: examine(foot=[0.1, 0.1]), "must be 3 long"),
    "examine_posture, yaw": (
        lambda: examine([0.1, 0.2, 0.3, 0.0], dl.SCARA, foot=[0.3, 0.1, 0.4], yaw="x"),
        "the yaw is 'x'",
    ),
    "examine_posture, yaw alone": (lambda: examine(yaw=0.1), "yaw goes with a point"),
    "examine_posture, rpy alone": (lambda: examine(rpy=[0, 0, 0]), "rpy goes with a point"),
    "examine_posture, rpy": (lambda: examine(foot=[0.1, 0, 0], rpy="x"), "rpy is 'x'"),
}


@pytest.mark.parametrize(("call", "words"), CALLS.values(), ids=CALLS)
def test_a_wrong_argument_is_refused_in_one_sentence(call, words):
    with pytest.raises(InvalidValueError, match=words) as refusal:
        call()
    assert "\n" not in str(refusal.value)


def test_arrays_and_lists_are_taken_as_well_as_tuples():
    assert dl.examine_posture(dl.LEG_B, np.array(Q)).rank.rank == 3
    assert dl.SineStep(direction=np.array([0.0, 1.0, 0.0])).length == 0.14
    assert robot(segments=list(dl.LEG_B.segments)).segments == dl.LEG_B.segments
