"""Wrong arguments to the front door's diagrams, blocks and pictures are refused in a sentence."""

import math
from dataclasses import replace

import numpy as np
import pytest

import drake_leg as dl
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.errors import InvalidValueError

PLANT = dl.build_plant(dl.LEG_B)
WORLD = PLANT.world_frame()
SWING = dl.build_pendulum(dl.PendulumConfig())
LEG = dl.HexabotLegConfig

REFUSED = {
    "EnergySensor": [(dl.LEG_B,), (None,), ("leg",)],
    "FrameSensor": [(dl.LEG_B, None), (PLANT, None), (PLANT, WORLD, 3), (PLANT, "foot")],
    "block_diagram": [(dl.LEG_B,), (PLANT,), (None,), ("leg-b",)],
    "build_pendulum": [(LEG(),), (dl.PENDULUM,), (None,)],
    "build_ellipse": [(LEG(),), (dl.LEG_B,), ("ellipse",)],
    "build_hexabot_leg": [(dl.LEG_B,), (dl.ScaraConfig(),), (0.05,), (dl.EllipseConfig(),)],
    "build_kinematic_loop": [(dl.LEG_B,), (dl.PendulumConfig(),), (None,), ("leg-b",)],
    "build_scara": [(LEG(),), (dl.SCARA,), (None,)],
    "add_scope": [(1, 2, 3), (None, "q", None)],
    "DriftCorrection": [(1, (0, 0)), ("2", (0, 0, 0)), (1, None), (1, "abc"), (1, 0.5)],
    "InputFilter": [("2",), (0,), (True,), (2, "x"), (1.5,), (None,)],
    "JointStops": [(dl.LEG_B, {}), (PLANT, None), (PLANT, {"hip": 3}), (PLANT, {})],
    "PrescribedMotion": [(dl.LEG_B,), (PLANT, 5), (PLANT, ["x"]), (None,), (PLANT, [None])],
    "InverseJacobian": [(3,), (dl.LEG_B,), (None,)],
}
REFUSED_SETTINGS = {
    "FrameSensor": [{"euler": 3}, {"observed_in": 3}, {"expressed_in": "foot"}],
    "block_diagram": [{"part": 3}, {"background": "red"}, {"robot": "leg-b"}, {"title": 5}],
    "InputFilter": [{"order": 3}, {"order": [1]}, {"initial": [1]}, {"initial": "ab"}],
    "PrescribedMotion": [{"stiffness": "x"}, {"believed": 3}],
    "HexabotLegConfig": [
        {"robot": "leg-b"},
        {"q0": None},
        {"q0": "abc"},
        {"q0": 1.0},
        {"q0": (1.0, 2.0)},
        {"q0": ("a", 1, 2)},
        {"q0": (10**400, 0.0, 0.0)},
        {"motion": 0.05},
        {"motion": dl.EllipticStep()},
        {"gain": "2"},
        {"gain": 10**400},
        {"gravity": "x"},
        {"gravity": 10**5000},
        {"filter_time_constant": "x"},
        {"feedback": 3},
        {"feedback": "felt"},
        {"task": 3},
        {"task": 10**5000},
        {"task": "both"},
        {"control": 3},
        {"control": Control(q0_error=(0.1,))},
        {"disturbance": "push"},
    ],
    "EllipseConfig": [{"motion": dl.SineStep()}, {"q0": None}, {"robot": dl.SCARA.name}],
    "ScaraConfig": [
        {"R": "x"},
        {"motion": 3},
        {"motion": dl.EllipticStep()},
        {"robot": dl.LEG_B},
        {"q0": (1.0,)},
        {"q0": None},
    ],
    "PendulumConfig": [{"q0": (1.0,)}, {"q0": "x"}, {"robot": dl.LEG_B}, {"gravity": None}],
}
FIRST = {"FrameSensor": (PLANT, WORLD), "block_diagram": (SWING,), "InputFilter": (2,)}
FIRST["PrescribedMotion"] = (PLANT,)
CALLS = [(name, given, {}) for name, calls in REFUSED.items() for given in calls]
CALLS += [
    (name, FIRST.get(name, ()), settings)
    for name, calls in REFUSED_SETTINGS.items()
    for settings in calls
]


@pytest.mark.parametrize(("name", "given", "settings"), CALLS)
def test_a_wrong_argument_is_refused_in_one_sentence(name, given, settings):
    with pytest.raises(InvalidValueError) as refusal:
        getattr(dl, name)(*given, **settings)
    said = str(refusal.value)
    assert "incompatible" not in said
    assert "\n" not in said
    assert len(said) < 250


def test_every_name_of_these_rooms_is_tried():
    rooms = ("drake_leg.diagrams", "drake_leg.systems", "drake_leg.pictures.block_diagram")
    names = {name for name, (module, _) in dl._HOMES.items() if module.startswith(rooms)}
    assert names == {*REFUSED, *REFUSED_SETTINGS}


@pytest.mark.parametrize("settings", [{"inverse": "damped"}, {"q0_error": 3}, {"correction": "x"}])
def test_a_control_checks_itself(settings):
    with pytest.raises(InvalidValueError, match=next(iter(settings)).split("_")[0]):
        Control(**settings)


@pytest.mark.parametrize("settings", [{"push": 3}, {"mass_error": "x"}, {"torque_limit": "x"}])
def test_a_disturbance_checks_itself(settings):
    with pytest.raises(InvalidValueError, match=next(iter(settings))):
        Disturbance(**settings)


def test_a_sentence_tells_the_remedy():
    with pytest.raises(InvalidValueError, match="such as LEG_B, or load one with load_robot"):
        LEG(robot="leg-b")
    with pytest.raises(InvalidValueError, match=r"plant is <Robot .* with build_plant\(robot\)"):
        dl.EnergySensor(dl.LEG_B)


def test_arrays_and_lists_are_taken_for_tuples():
    assert LEG(q0=np.array([1.57, -0.87, -1.57])).start[0] == 1.57
    assert LEG(q0=[1, 0.5, -1], gain=np.float64(2.0)).gain == 2.0
    assert LEG(q0=np.array(LEG().q0)) == LEG()


@pytest.mark.parametrize("direction", [np.array([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]])
def test_a_diagram_follows_an_array_or_a_list(direction):
    given = dl.build_hexabot_leg(LEG(motion=dl.SineStep(direction=direction)))
    same = dl.build_hexabot_leg(LEG(motion=dl.SineStep(direction=tuple(direction))))
    names = [[system.get_name() for system in one.GetSystems()] for one in (given, same)]
    assert names[0] == names[1]


def test_the_motion_of_another_diagram_is_refused_with_the_one_to_build():
    with pytest.raises(InvalidValueError, match=r"EllipticStep, and .* on a line: .*build_ellipse"):
        dl.build_hexabot_leg(dl.EllipseConfig())


def planar():
    links = [dl.LEG_B.segments[1], dl.LEG_B.segments[2]]
    rows = [replace(one, row=replace(one.row, alpha=0.0)) for one in links]
    return replace(dl.LEG_B, name="planar", segments=(*rows, dl.LEG_B.segments[3]))


def test_an_ellipse_is_refused_where_the_foot_cannot_rise():
    q0 = (0.5, 0.8)
    assert dl.EllipseConfig(robot=planar(), q0=q0, motion=dl.EllipticStep(lift=0.0)).q0 == q0
    with pytest.raises(InvalidValueError, match=r"cannot go along \(0, 0, 1\): make the lift 0"):
        dl.EllipseConfig(robot=planar(), q0=q0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: LEG(q0=(90, -50, -90)),
        lambda: dl.EllipseConfig(q0=(90, -50, -90)),
        lambda: dl.ScaraConfig(q0=(30.0, 40.0, 0.0)),
        lambda: dl.PendulumConfig(q0=90),
    ],
)
def test_degrees_are_asked_about(make):
    with pytest.raises(InvalidValueError, match=r"if degrees were meant, give math.radians\("):
        make()


def test_many_turns_that_were_degrees_are_radians():
    assert dl.PendulumConfig(q0=math.radians(1000)).start == math.radians(1000)
    assert dl.PendulumConfig(q0=4 * math.pi).start == 4 * math.pi
