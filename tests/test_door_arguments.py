"""Wrong arguments to the front door's robots, motions and examinations, each refused in words."""

import math

import numpy as np
import pytest

import drake_leg as dl
from drake_leg.errors import InvalidValueError

Q = [1.57, -0.87, -1.57]
DEGREES = (90, -50, -90)
GIVE_RADIANS = r"more than two turns: if degrees were meant, give math.radians\(90\)"
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
    "SineStep, nan": (lambda: dl.SineStep(amplitude=NOT_A_NUMBER), "the amplitude is nan; it"),
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
        r"the direction is \(an integer too large for a float, 0, 0\); it must be three",
    ),
    "EllipticStep, lift": (lambda: dl.EllipticStep(lift="x"), "the lift is 'x'"),
    "EllipticStep, no lift": (lambda: dl.EllipticStep(lift=None), "the lift is None"),
    "EllipticStep, nan": (lambda: dl.EllipticStep(lift=NOT_A_NUMBER), "the lift is nan; it"),
    "EllipticStep, direction": (lambda: dl.EllipticStep(direction=[1]), "three finite numbers"),
    "EllipticStep, amplitude": (lambda: dl.EllipticStep(amplitude={}), "the amplitude is {}"),
    "load_robot, number": (lambda: dl.load_robot(3), "the path of a robot file is 3"),
    "load_robot, nothing": (lambda: dl.load_robot(None), "the path of a robot file is None"),
    "load_robot, no file": (lambda: dl.load_robot("no such file"), "cannot be read"),
    "load_robot, null": (lambda: dl.load_robot("a\0b"), "cannot be read"),
    "Recording, number": (lambda: dl.Recording(3), "columns of a recording is 3; it must be a Map"),
    "Recording, header": (lambda: dl.Recording({1: [2.0]}), "the header of a column is 1"),
    "Recording, text": (lambda: dl.Recording({"a": ["x"]}), r"a is \['x'\]; it must be real"),
    "Recording, a word": (lambda: dl.Recording({"time [s]": "abc"}), "the column time is 'abc'"),
    "Recording, words": (lambda: dl.Recording({"a": np.array(["1"])}), "it must be real numbers"),
    "Recording, empty": (lambda: dl.Recording({}), "a recording has no columns: give one"),
    "Recording, a path": (lambda: dl.Recording("x.csv"), r"Recording.read_csv\(path\)"),
    "Recording, no file": (lambda: dl.Recording.read_csv(3), "path of a recording is 3"),
    "Recording, no target": (
        lambda: dl.Recording({"a": [1.0]}).write_csv(3),
        "path of a recording is 3",
    ),
    "HexabotLegConfig, huge gain": (
        lambda: dl.HexabotLegConfig(gain=10**300),
        r"the gain is 1e\+300; it must be finite",
    ),
    "HexabotLegConfig, huge q0": (
        lambda: dl.HexabotLegConfig(q0=(10**400, 0, 0)),
        r"q0 is \(an integer too large for a float, 0, 0\)",
    ),
    "HexabotLegConfig, gravity": (
        lambda: dl.HexabotLegConfig(gravity=NOT_A_NUMBER),
        r"gravity is nan m/s\^2",
    ),
    "EllipseConfig, gravity": (lambda: dl.EllipseConfig(gravity=math.inf), "gravity is inf"),
    "ScaraConfig, gravity": (lambda: dl.ScaraConfig(gravity=-1.0), "gravity is -1.0"),
    "PendulumConfig, gravity": (lambda: dl.PendulumConfig(gravity=10**300), r"gravity is 1e\+300"),
    "InputFilter, huge": (lambda: dl.InputFilter(10**400), "size is an integer too large for a"),
    "InputFilter, many": (lambda: dl.InputFilter(10**9, 0.1), "the number of signals, 1 to 1000"),
    "errata, huge": (lambda: dl.errata(10**400), "no erratum an integer too large for a float;"),
    "errata, great": (lambda: dl.errata(10**50), r"there is no erratum 1e\+50;"),
    "view, port": (lambda: dl.view(dl.LEG_B, port=10**400), "port is an integer too large for"),
    "report, huge": (lambda: dl.report(10**400), "folder is an integer too large for a float;"),
    "run, huge": (lambda: dl.run(10**400), "there is no run an integer too large for a float"),
    "movable, huge task": (
        lambda: dl.movable(dl.LEG_B, task=10**400),
        "the task is an integer too large for a float",
    ),
    "movable, degrees": (lambda: dl.movable(dl.LEG_B, DEGREES), GIVE_RADIANS),
    "examine_posture, degrees": (lambda: examine(DEGREES), GIVE_RADIANS),
    "still, degrees": (lambda: dl.still(dl.LEG_B, DEGREES), GIVE_RADIANS),
    "movable, digits": (lambda: dl.movable(dl.LEG_B, ("1", "2", "3")), "must be real numbers"),
    "examine_posture, digits": (lambda: examine(("1", "2", "3")), "it must be real numbers"),
    "examine_posture, objects": (
        lambda: examine(np.array(["1", 2.0, 3.0], dtype=object)),
        "it must be real numbers",
    ),
    "still, digits": (lambda: dl.still(dl.LEG_B, ("1", "2", "3")), "it must be real numbers"),
    "Recording, flat": (lambda: dl.Recording({"a": 1.0}), r"the column a has shape \(\)"),
    "errata, text": (lambda: dl.errata("1"), "an erratum is '1'; it must be a whole number"),
    "errata, in text": (lambda: dl.errata("5"), r"give errata\(5\)"),
    "errata, in a list": (lambda: dl.errata([5, 6]), r"give errata\(5, 6\)"),
    "errata, True": (lambda: dl.errata(True), "an erratum is True; it must be a whole number"),
    "errata, float": (lambda: dl.errata(5.0), "an erratum is 5.0; it must be a whole number"),
    "errata, list": (lambda: dl.errata([1]), r"an erratum is \[1\]; it must be a whole number"),
    "report, number": (lambda: dl.report(3), "folder is 3; it must be a str or Path"),
    "report, nothing": (lambda: dl.report(None), "folder is None; it must be a str or Path"),
    "block_diagram, path": (
        lambda: dl.block_diagram(dl.build_pendulum(dl.PendulumConfig())).write(5),
        "path is 5; it must be a str or Path",
    ),
    "Recording, path": (
        lambda: dl.Recording({"time[s]": [0.0]}).write_csv(5),
        "path of a recording is 5",
    ),
    "write_video, path": (
        lambda: dl.write_video(dl.LEG_B, "a.gif", None),
        "target is <Robot leg_b",
    ),
    "build, nothing": (lambda: dl.build_pendulum(), r"build_pendulum needs config: give Pend"),
    "build, keyword": (
        lambda: dl.build_hexabot_leg(robot=dl.LEG_B),
        r"build_hexabot_leg has no argument 'robot'; it takes config: give HexabotLegConfig\(",
    ),
    "build, too many": (
        lambda: dl.build_scara(dl.ScaraConfig(), 1),
        r"build_scara takes config \(too many",
    ),
    "build, robot": (
        lambda: dl.build_hexabot_leg(dl.LEG_B),
        r"config is <Robot .*: give HexabotLegConfig\(robot=...\), as build_hexabot_leg\(",
    ),
    "block_diagram, keyword": (
        lambda: dl.block_diagram(None, prt="all"),
        r"block_diagram has no argument 'prt'; .*: did you mean part\?",
    ),
    "HexabotLegConfig, control": (
        lambda: dl.HexabotLegConfig(control="damped"),
        "with from drake_leg.diagrams.additions import Control",
    ),
    "simulate, settings": (
        lambda: dl.simulate(dl.build_pendulum(dl.PendulumConfig()), 1.0, settings="runge_kutta5"),
        "with from drake_leg.simulation.integrator import IntegratorSettings",
    ),
    "simulate, config": (
        lambda: dl.simulate(dl.HexabotLegConfig(), duration=1),
        r"^diagram is a HexabotLegConfig; .*: build it first, as build_hexabot_leg\(config\)$",
    ),
    "simulate, robot": (lambda: dl.simulate(dl.LEG_B, 1.0), "^diagram is <Robot .* must be a Di"),
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
    assert "0" * 50 not in str(refusal.value)


def test_arrays_and_lists_are_taken_as_well_as_tuples():
    assert dl.examine_posture(dl.LEG_B, np.array(Q)).rank.rank == 3
    assert dl.SineStep(direction=np.array([0.0, 1.0, 0.0])).length == 0.14
    assert robot(segments=list(dl.LEG_B.segments)).segments == dl.LEG_B.segments


def test_an_angle_converted_from_degrees_may_be_many_turns():
    many = [math.radians(angle) for angle in (1000.0, -50.0, -90.0)]
    assert dl.examine_posture(dl.LEG_B, many).rank.rank == 3
    assert dl.movable(dl.LEG_B, many).joints == 3


def test_the_lift_of_a_scara_is_no_angle():
    assert dl.movable(dl.SCARA, [0.1, 0.2, 0.3, 20.0]).joints > 0


def test_a_recording_is_written_and_read_at_a_path_in_text(tmp_path):
    written = dl.Recording({"time [s]": [0.0, 0.1], "n[1]": np.array([1, 2])})
    assert (written.unit("time"), written["time"].tolist()) == ("s", [0.0, 0.1])
    written.write_csv(str(tmp_path / "a.csv"))
    again = dl.Recording.read_csv(str(tmp_path / "a.csv"))
    assert list(again.columns) == ["time [s]", "n[1]"]
    assert again["n"].tolist() == [1.0, 2.0]
