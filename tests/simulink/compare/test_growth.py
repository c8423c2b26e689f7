"""The work of a comparison grows in proportion to the model."""

import sys

import large_models
import pytest

from drake_leg.simulink.compare.compare import compare
from drake_leg.simulink.compare.models import compare_models
from drake_leg.simulink.reader import read_model


def lines_run(work):
    """Count the lines of Python that some work runs; a loop on one line counts each round."""
    count = 0

    def trace(frame, event, arg):
        nonlocal count
        count += event == "line"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(before)
    return count


@pytest.mark.slow
@pytest.mark.parametrize(
    ("draw", "size"),
    [
        (large_models.mechanical_chain, 40),
        (large_models.rigid_chain, 40),
        (large_models.parallel_signals, 60),
        (large_models.signals_in_a_row, 60),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
@pytest.mark.parametrize("with_itself", [False, True], ids=["a run", "itself"])
def test_twice_the_blocks_are_about_twice_the_work(tmp_path, live, draw, size, with_itself):
    run, counts = live("leg-b"), []
    for factor in (1, 2, 4):
        model = read_model(draw(factor * size).write(tmp_path / "model.slx"))

        def work(model=model):
            return compare_models(model, model, "B") if with_itself else compare(model, run)

        counts.append(lines_run(work))
    one, two, four = counts
    assert (four - two) / (two - one) < 2.4  # 2 where it is in proportion, 4 where it is quadratic
