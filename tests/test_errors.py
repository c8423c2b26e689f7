"""Every error that this package documents is provoked, and says its one sentence."""

import ast
import copy
import importlib
import inspect
import pickle
import pkgutil
import re
import sys
from dataclasses import replace
from http import HTTPStatus
from pathlib import Path

import numpy as np
import pytest

import drake_leg
from drake_leg.errors import (
    BrokenPackageError,
    DrakeLegError,
    ForeseenSingularityError,
    ImpossibleWalkError,
    InvalidValueError,
    JointLimitError,
    LostMotionError,
    MissingNumbersError,
    MissingThingsError,
    OutputError,
    PictureError,
    PlaceError,
    SingularConfigurationError,
    StepBudgetError,
    TimeBudgetError,
    UnknownValueError,
    UnplacedFeatureError,
    UnreadableFileError,
    UnstableRunError,
)
from drake_leg.files import check_target, read_text
from drake_leg.kinematics.movable import exact_rates
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.lab.page.pieces import UnlikeReplaysError
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_B
from drake_leg.runs import pendulum
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import LegBOptions, StraightOptions
from drake_leg.runs.pendulum_options import PendulumOptions
from drake_leg.runs.step import run as run_robot
from drake_leg.scene import artists, media
from drake_leg.scene.artists import NoRenderingError
from drake_leg.scene.motion import OtherRobotError
from drake_leg.scene.server import RefusedError, ServerError
from drake_leg.scene.web_page import MeshcatError, PageError
from drake_leg.simulation import following
from drake_leg.simulation import run as simulation_run
from drake_leg.simulink.running.solving import UnsolvedLoopError, solved

run_leg = RUNS["leg-b"].run
run_pendulum = RUNS["pendulum"].run


def errors_of_the_package():
    """Every class of error that some module defines."""
    found = {}
    for module in pkgutil.walk_packages(drake_leg.__path__, "drake_leg."):
        if module.name == "drake_leg.__main__":
            continue
        for kind in vars(importlib.import_module(module.name)).values():
            if inspect.isclass(kind) and issubclass(kind, Exception):
                found[kind.__name__] = kind
    return [kind for kind in found.values() if kind.__module__.startswith("drake_leg.")]


PROVOKED_ELSEWHERE = {
    MeshcatError: "tests/scene/test_web_page.py",
    PageError: "tests/scene/test_web_page.py",
    RefusedError: "tests/scene/test_server_requests.py",
    UnlikeReplaysError: "tests/lab/page/test_replays.py",
    ServerError: "tests/scene/test_server.py",
    OtherRobotError: "tests/scene/test_scene.py",
    TimeBudgetError: "tests/test_progress.py",
    MissingNumbersError: "tests/robot/symoro/test_as_robot.py",
    UnknownValueError: "tests/simulink/test_parameters.py",
    MissingThingsError: "tests/simulink/running/test_running.py",
    UnplacedFeatureError: "tests/simulink/multibody/test_placed_features.py",
}


def cause(run, monkeypatch):
    """What stopped the simulation of a run, which goes on to its outcome."""
    stops = []

    def watched(*arguments, **keywords):
        stops.append(simulation_run.simulate(*arguments, **keywords))
        return stops[0]

    for module in (following, pendulum):
        monkeypatch.setattr(module, "simulate", watched)
    run()
    return stops[-1].stopped_by


def invalid(monkeypatch, tmp_path):
    run_leg(LegBOptions(duration=-1.0))


def output(monkeypatch, tmp_path):
    check_target(tmp_path, overwrite=False)


def singular(monkeypatch, tmp_path):
    exact_rates(LEG_JACOBIAN, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0])


LEG_JACOBIAN = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]


def foreseen(monkeypatch, tmp_path):
    run_leg(LegBOptions(amplitude=0.1))


def lost(monkeypatch, tmp_path):
    options = LegBOptions(
        amplitude=0.1, duration=4.0, integrator="radau3", force=True, dynamics="forward"
    )
    raise cause(lambda: run_leg(options), monkeypatch)


def budget(monkeypatch, tmp_path):
    monkeypatch.setattr(simulation_run, "STEP_BUDGET", 20)
    options = LegBOptions(duration=0.8, accuracy=1e-12)
    raise cause(lambda: run_leg(options), monkeypatch)


def unstable(monkeypatch, tmp_path):
    options = PendulumOptions(duration=5.0, q0=[20.0], damping=10.0, max_step=0.04)
    raise cause(lambda: run_pendulum(options), monkeypatch)


def limit(monkeypatch, tmp_path):
    hip, knee, *rest = LEG_B.segments
    narrow = replace(knee, mechanics=JointMechanics(lower=-0.88, upper=-0.86))
    motion = {"amplitude": 0.07, "duration": 4.0, "dynamics": "forward"}
    options = StraightOptions(q0=[90.0, -50.0, -90.0], **motion)
    robot = replace(LEG_B, segments=(hip, narrow, *rest))
    raise cause(lambda: run_robot(robot, options), monkeypatch)


def impossible_walk(monkeypatch, tmp_path):
    walk = walk_of(HEXABOT, commands=[Command(forward=1.0, start=1.0)])
    foresee_walk(HEXABOT, walk).require_walkable()


def no_rendering(monkeypatch, tmp_path):
    monkeypatch.setattr(artists, "rendering_fault", lambda: "there is no VTK here")
    media.require_video(tmp_path / "a.gif")


def no_encoder(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "av", None)
    media.require_video(tmp_path / "a.mp4")


def unreadable(monkeypatch, tmp_path):
    read_text(tmp_path)


def picture(monkeypatch, tmp_path):
    raise PictureError("the figure angle", KeyError("q"))


def unsolved(monkeypatch, tmp_path):
    solved(lambda z: z**2 + 1.0, (np.ones(1), None), "the algebraic loop of 'a'")


PROVOKED = {
    UnsolvedLoopError: unsolved,
    InvalidValueError: invalid,
    UnreadableFileError: unreadable,
    PictureError: picture,
    PlaceError: output,
    SingularConfigurationError: singular,
    ForeseenSingularityError: foreseen,
    LostMotionError: lost,
    StepBudgetError: budget,
    UnstableRunError: unstable,
    JointLimitError: limit,
    ImpossibleWalkError: impossible_walk,
    NoRenderingError: no_rendering,
    BrokenPackageError: no_encoder,
}


@pytest.mark.parametrize("kind", PROVOKED, ids=lambda kind: kind.__name__)
def test_an_error_comes_where_it_is_due_and_is_pickled_and_copied(kind, monkeypatch, tmp_path):
    with pytest.raises(DrakeLegError) as caught:
        PROVOKED[kind](monkeypatch, tmp_path)
    assert type(caught.value) is kind
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) > 20
    for again in (pickle.loads(pickle.dumps(caught.value)), copy.deepcopy(caught.value)):
        assert same(caught.value, again)


def same(error, other):
    return (type(other), str(other), other.args, vars(other)) == (
        type(error),
        str(error),
        error.args,
        vars(error),
    )


SAMPLES = {
    "str": "word",
    "object": "word",
    "int": 3,
    "int | None": 3,
    "bool": True,
    "float": 0.5,
    "float | None": 0.5,
    "str | None": "word",
    "Exception": ValueError("no"),
    "HTTPStatus": HTTPStatus.FORBIDDEN,
    "Sequence[float]": (1.0, 2.0),
    "tuple[float, float]": (-1.0, 1.0),
    "Mapping[str, str]": {"D3": "d of row 3"},
    "Iterable[str]": ("L1",),
    "tuple[str, ...]": ("L1",),
}


def made(kind):
    """An error of a kind, from one sample for every argument of its constructor."""
    words, settings = [], {}
    for parameter in inspect.signature(kind).parameters.values():
        sample = SAMPLES[parameter.annotation]
        if parameter.kind is parameter.KEYWORD_ONLY:
            settings[parameter.name] = sample
        else:
            words.append(sample)
    return kind(*words, **settings)


@pytest.mark.parametrize("kind", errors_of_the_package(), ids=lambda kind: kind.__name__)
def test_an_error_of_any_kind_is_pickled(kind):
    error = made(kind)
    error.where = (1.0, "here")
    error.add_note("a note")
    assert str(error)
    assert same(error, pickle.loads(pickle.dumps(error)))


OPTION = re.compile(r"(?<![-\w])--[a-z]")


def test_no_sentence_of_the_library_names_an_option_of_the_command_line():
    """But for the pages that print whole commands, in lab and report, and scripts."""
    for path in Path(drake_leg.__file__).parent.rglob("*.py"):
        if {"cli", "lab", "porting", "report"}.isdisjoint(path.parts):
            source = path.read_text(encoding="utf-8")
            if OPTION.search(source):
                for text in texts(ast.parse(source)):
                    assert "pip install" in text or not OPTION.search(text), path


def texts(tree):
    """Every string of a module, without its docstrings."""
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    strings = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return [
        node.value for node in strings if isinstance(node.value, str) and id(node) not in docstrings
    ]


def test_what_a_singularity_stopped_is_pickled(monkeypatch):
    options = LegBOptions(amplitude=0.1, duration=4.0, force=True)
    outcomes = []
    stopped_by = cause(lambda: outcomes.append(run_leg(options)), monkeypatch)
    assert same(stopped_by, pickle.loads(pickle.dumps(stopped_by)))
    assert stopped_by.__traceback__ is None
    again = pickle.loads(pickle.dumps(outcomes[0]))
    assert again.summary == outcomes[0].summary
    assert again.robot == outcomes[0].robot


def test_none_is_forgotten():
    public = {
        kind
        for kind in errors_of_the_package()
        if issubclass(kind, DrakeLegError) and kind.__name__[0] != "_"
    }
    assert public - {DrakeLegError, OutputError} == set(PROVOKED) | set(PROVOKED_ELSEWHERE)
