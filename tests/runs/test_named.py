"""A named run from Python: what it takes, what it refuses in a sentence, what it returns."""

import dataclasses
import gc
import pickle
from fractions import Fraction

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.robot.toml.writer import robot_toml
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.named import run
from drake_leg.runs.option import type_of
from drake_leg.runs.options import StraightOptions

KINDS = {name: kind.options for name, kind in RUNS.items()} | {"own": StraightOptions}
OPTIONS = [(name, field) for name, kind in KINDS.items() for field in dataclasses.fields(kind)]
IDS = [f"{name} {field.name}" for name, field in OPTIONS]
NAN, INF = float("nan"), float("inf")
WRONG = {
    float: ["2", [2.0], (1, 2), True, {}, 2j, NAN, -INF, 10**400, b"2", np.array([1.0]), object()],
    list: ["90,-50,-90", {}, {1.0, 2.0, 3.0}, True, ["90"], [None], [NAN, 0, 0], [INF], [[1, 2, 3]],
           object(), len, np.eye(3), b"123"],
    str: [5, True, ["runge_kutta5"], b"radau3", {}],
    bool: [3, 0, "yes", [True], 1.0],
}  # fmt: skip


@pytest.mark.parametrize(("name", "option"), OPTIONS, ids=IDS)
def test_an_option_of_a_wrong_type_is_refused_with_its_name_and_value(name, option):
    wrong = [*WRONG[type_of(option)], *([] if "None" in str(option.type) else [None])]
    for value in wrong:
        with pytest.raises(
            InvalidValueError, match=rf"^{option.name} is .*; it must be "
        ) as caught:
            run(LEG_B if name == "own" else name, **{option.name: value})
        assert "\n" not in str(caught.value)
        assert len(str(caught.value)) < 200


@pytest.mark.parametrize(("name", "option"), OPTIONS, ids=IDS)
def test_numbers_of_any_kind_are_the_same_option(name, option):
    default = getattr(KINDS[name](), option.name)
    if isinstance(default, float):
        likes = [np.float64(default), Fraction(default)]
    elif isinstance(default, list):
        likes = [tuple(default), np.array(default)]
    else:
        return
    for like in likes:
        assert KINDS[name](**{option.name: like}) == KINDS[name]()
        assert type(getattr(KINDS[name](**{option.name: like}), option.name)) is type(default)


def test_a_single_number_is_a_list_of_one_as_on_the_command_line():
    assert RUNS["pendulum"].options(q0=45).q0 == [45.0]
    with pytest.raises(InvalidValueError, match=r"q0 is \[90\.0\]; .* as `q0=\[90, -50, -90\]`"):
        run("leg-b", q0=90)


@pytest.mark.parametrize("what", [3, None, b"leg-b", ["leg-b"], "leg", "", 2.5])
def test_what_is_no_run_is_refused_with_the_runs(what):
    with pytest.raises(InvalidValueError, match=r"there is no run .*; the runs are pendulum, "):
        run(what)


def test_a_run_that_is_misspelt_is_guessed():
    with pytest.raises(InvalidValueError, match=r"'leg_b'; .*: did you mean leg-b\?"):
        run("leg_b")


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"out": 3}, "out is 3; it must be the path of a folder"),
        ({"progress": 3}, "progress is 3; it must be a function"),
        ({"figures": None}, r"figures is None; it must be one of none, png, svg, pdf, all$"),
        ({"figures": "jpg"}, "figures is 'jpg'; it must be one of none, png, svg, pdf, all"),
        ({"figure": "svg"}, r"has no option 'figure': did you mean figures\?"),
        ({"overwrite": "yes"}, "overwrite is 'yes'; it must be true or false"),
    ],
)
def test_what_all_runs_take_is_checked(settings, said):
    with pytest.raises(InvalidValueError, match=said):
        run("leg-b", **settings)


@pytest.mark.parametrize("name", RUNS)
def test_a_result_is_pickled_with_its_figures(name):
    result = run(name, duration=0.3)
    again = pickle.loads(pickle.dumps(result))
    assert (again.summary, again.robot, again.title) == (
        result.summary,
        result.robot,
        result.title,
    )
    assert list(again.figures) == list(result.figures)
    first = next(iter(again.figures))
    assert again.figures[first].axes


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, SCARA], ids=lambda robot: robot.name)
def test_a_reports_robot_starts_where_its_own_run_does(robot):
    result, own = run(robot, duration=0.1), run(robot.name.replace("_", "-"), duration=0.1)
    for column in ("q1", "q2", "q3"):
        assert result.recording[column][0] == own.recording[column][0]
    assert result.summary["max_position_error_m"] < 1e-9


def test_the_path_of_a_toml_file_is_a_robot(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(robot_toml(LEG_B), encoding="utf-8")
    for what in (path, str(path)):
        result = run(what, duration=0.1)
        assert (result.name, result.robot) == (str(path), LEG_B)
    with pytest.raises(UnreadableFileError, match=r"no\.toml cannot be read"):
        run("no.toml")


@pytest.mark.slow
@pytest.mark.parametrize("dynamics", ["none", "inverse"])
def test_many_runs_keep_nothing(dynamics):
    """Objects are counted here, megabytes by tests/benchmarks/memory.py."""

    def kept_after(runs):
        for _ in range(runs):
            run("leg-b", dynamics=dynamics, duration=0.1)
        gc.collect()
        return len(gc.get_objects())

    kept_after(3)
    assert kept_after(20) <= kept_after(1) + 10
