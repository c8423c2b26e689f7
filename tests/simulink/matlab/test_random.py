"""Random numbers are those that MATLAB draws by default."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.workspace import Workspace

PRINTED = [0.8147, 0.9058, 0.1270, 0.9134, 0.6324]  # by MATLAB, for rand(1, 5) at its start


def values(script):
    workspace = Workspace()
    workspace.run(script, name="it")
    return workspace.variables


def test_numbers_at_the_start_are_those_that_matlab_prints():
    assert np.round(values("x = rand(1, 5);")["x"], 4).tolist() == [PRINTED]


@pytest.mark.parametrize("seed", ["rng default", "rng('default')", "rng(0)", "rng(0, 'twister')"])
def test_a_seed_begins_anew(seed):
    found = values(f"a = rand(3); {seed}; x = rand; y = rand(2, 2);")
    assert round(found["x"], 4) == PRINTED[0]
    assert np.round(found["y"], 4).tolist() == [PRINTED[1::2], PRINTED[2::2]]


def test_other_seeds_draw_other_numbers():
    assert values("rng(42); x = rand;")["x"] == np.random.RandomState(42).random_sample()


def test_whole_numbers():
    found = values("x = randi(10, 1, 5); rng default; y = randi([-1 1], 5, 1);")
    assert found["x"].tolist() == [[9, 10, 2, 10, 7]]
    assert found["y"].tolist() == [[1], [1], [-1], [1], [0]]


@pytest.mark.parametrize(
    "script", ["rng shuffle; x = rand;", "x = randn;", "x = rand('seed', 3);", "s = rng; x = s;"]
)
def test_what_is_not_drawn_has_no_value(script):
    assert "x" not in values(script)


def test_a_function_draws_on_where_its_last_call_stopped():
    function = compiled("function y = f(u)\ny = u + rand(2, 1);")
    kept = function.start()
    first = function.call(kept, 0.0)[0]
    there = dict(kept)
    second = function.call(kept, 0.0)[0]
    function.call(kept, 0.0)
    assert np.round([*first, *second], 4).tolist() == PRINTED[:4]
    assert function.call(there, 0.0)[0].tolist() == second.tolist()
    assert "entry" in function.source


def test_a_seed_that_makes_no_sense_is_refused():
    with pytest.raises(InvalidValueError, match="the seed -1 is not between 0 and 4294967295"):
        compiled("function y = f(u)\nrng(-1);\ny = u;").call({}, 1.0)
