"""Own steps: their order, stiff equations, jumps, and where they must give up."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drake_leg.simulink.running.solution import Solution, StepError
from drake_leg.simulink.running.stepping import tentative


def swing(t, x):
    return np.array([x[1], -x[0] * np.cos(t) + np.sin(x[1] * t)])


def lag(t, x):
    """A stiff lag behind a sine, from where it follows it exactly."""
    return -1e6 * (x - np.sin(t)) + np.cos(t)


def solved(rates, x, end, accuracy, longest=1.0, corners=()):
    solution = Solution(
        rates, 0.0, np.array(x, dtype=float), accuracy=accuracy, longest=longest, shortest=1e-10
    )
    for corner in (*corners, end):
        while solution.t < corner:
            solution.step(corner)
    return solution


def of_equal_steps(count, method):
    """Solve by so many equal steps of a method, and look at the middle of each."""
    solution = Solution(
        swing, 0.0, np.array([1.0, 0.0]), accuracy=1e9, longest=2.0 / count, shortest=0.0
    )
    solution._choose({"rodas5p": solution._implicit, "dopri5": solution._explicit}[method], 1.0)
    solution._step = 2.0 / count
    solution._reconsider = lambda h: None
    between = []
    while solution.t < 2.0:
        solution.step(2.0)
        middle = solution.t - 1.0 / count
        between.append((middle, solution.at(middle)))
    assert solution.steps == count
    return solution.x, between


@pytest.mark.parametrize("method", ["rodas5p", "dopri5"])
def test_steps_are_of_order_5_and_between_them_4(method):
    exact = solve_ivp(
        swing, (0.0, 2.0), [1.0, 0.0], "DOP853", rtol=1e-13, atol=1e-13, dense_output=True
    )
    ends, middles = [], []
    for count in (16, 32, 64):
        x, between = of_equal_steps(count, method)
        ends.append(np.abs(x - exact.y[:, -1]).max())
        middles.append(max(np.abs(x - exact.sol(t)).max() for t, x in between))
    orders = np.log2(np.array(ends[:-1]) / ends[1:])
    assert orders.min() > 4.7
    assert np.log2(np.array(middles[:-1]) / middles[1:]).min() > 3.7
    assert ends[-1] < 1e-7


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8])
def test_the_accuracy_is_kept(accuracy):
    exact = solve_ivp(swing, (0.0, 2.0), [1.0, 0.0], "DOP853", rtol=1e-13, atol=1e-13)
    solution = solved(swing, [1.0, 0.0], 2.0, accuracy)
    assert np.abs(solution.x - exact.y[:, -1]).max() < 3.0 * accuracy


@pytest.mark.parametrize(("rates", "x"), [(swing, [1.0, 0.0]), (lag, [0.0])])
def test_ends_that_differ_by_rounding_cost_no_steps(rates, x):
    """A step to such an end, and a step as short behind it, would be too short to go on."""
    corners = [np.nextafter(at, 2.0) if late else at for at in (0.3, 0.7) for late in (0, 1)]
    solution = solved(rates, x, 1.0, 1e-6, corners=corners)
    assert solution.x == pytest.approx(solved(rates, x, 1.0, 1e-9).x, abs=1e-5)
    assert solution.steps <= solved(rates, x, 1.0, 1e-6, corners=(0.3, 0.7)).steps + 2


@pytest.mark.parametrize("method", ["rodas5p", "dopri5"])
def test_states_before_a_cut_are_those_of_the_whole_step(method):
    solution = Solution(
        swing, 0.0, np.array([1.0, 0.0]), accuracy=1e-6, longest=1.0, shortest=1e-10
    )
    solution._choose({"rodas5p": solution._implicit, "dopri5": solution._explicit}[method], 0.1)
    solution.step(1.0)
    whole = solution.at(0.3 * solution.t)
    solution.cut(0.6 * solution.t)
    assert solution.at(0.5 * solution.t) == pytest.approx(whole, abs=1e-12)


def test_stiff_equations_take_long_steps():
    """Its time constant is 1 us; explicit steps would be millions."""
    solution = solved(lag, [0.0], 10.0, 1e-6)
    assert abs(solution.x[0] - np.sin(10.0)) < 1e-6
    assert solution.steps < 80


def test_what_is_not_stiff_is_solved_by_explicit_steps():
    """Of two hundred swings an implicit step would need more than two hundred evaluations."""
    calls = []
    speeds = np.linspace(1.0, 3.0, 100)

    def rates(t, x):
        calls.append(t)
        return np.concatenate([x[100:], -(speeds**2) * x[:100]])

    solution = solved(rates, [1.0] * 100 + [0.0] * 100, 10.0, 1e-8)
    np.testing.assert_allclose(solution.x[:100], np.cos(10.0 * speeds), atol=1e-6)
    assert solution.methods == {"rodas5p", "dopri5"}
    assert len(calls) < 20 * solution.steps


def test_explicit_steps_give_way_where_it_becomes_stiff():
    """Four of five states are fast from 5 s on; the explicit steps of that time are few."""
    fast = np.array([0.0, 1.0, 1.1, 1.2, 1.3])

    def rates(t, x):
        follows = -(1e5 if t > 5.0 else 0.1) * fast * (x - np.sin(t) * (x[0] > -1.0))
        follows[0] = np.cos(t)
        return follows

    calls = []
    solution = solved(
        lambda t, x: (calls.append(t), rates(t, x))[1], [0.0] * 5, 10.0, 1e-6, corners=[5.0]
    )
    assert solution.x == pytest.approx(np.sin(10.0), abs=1e-4)
    assert len(calls) < 6000  # explicit steps alone would be a million


def test_no_step_looks_beyond_a_corner():
    seen = []

    def rates(t, x):
        seen.append(t)
        return np.array([1.0 if t < 0.5 else -2.0])

    solution = solved(rates, [0.0], 0.5, 1e-9)
    assert max(seen) < 0.5
    assert solution.x[0] == pytest.approx(0.5, abs=1e-14)
    assert solved(rates, [0.0], 1.0, 1e-9, corners=[0.5]).x[0] == pytest.approx(-0.5, abs=1e-14)


def test_what_jumps_elsewhere_is_met_by_short_steps():
    solution = solved(lambda t, x: np.array([1.0 if x[0] < 0.3 else 0.25]), [0.0], 1.0, 1e-8)
    assert solution.x[0] == pytest.approx(0.3 + 0.7 / 4.0, abs=1e-7)


def test_it_gives_up_at_a_pole_and_where_rates_are_no_numbers():
    with pytest.raises(StepError):
        solved(lambda t, x: x * x, [1.0], 2.0, 1e-6)
    with pytest.raises(StepError):
        solved(lambda t, x: np.where(t < 0.7, 1.0, np.nan) * x, [1.0], 2.0, 1e-6)


def test_states_that_are_no_numbers_are_never_asked_for():
    """Drake ends Python at positions that are not finite; what cannot be computed is no number."""

    def rates(t, x):
        assert np.isfinite(x).all()
        if t > 0.5:
            raise RuntimeError
        return np.array([1e300 * x[0]])

    solution = Solution(
        tentative(rates), 0.0, np.array([1e200]), accuracy=1e-3, longest=1.0, shortest=1e-10
    )
    with pytest.raises(StepError), np.errstate(all="ignore"):
        solution.step(1.0)


@pytest.mark.parametrize(("coarsest", "most"), [(1e-3, 1000), (1e-4, 1000), (0.0, None)])
def test_fast_swings_are_damped_if_the_accuracy_may_be_coarser(coarsest, most):
    """Nine light bodies on stiff springs ride on a slow one; their speed is 1e-4 m/s at most.

    Explicit steps would keep them swinging, some 400 000 of them.
    """
    speeds = 1e5 * np.linspace(1.0, 2.0, 9)

    def rates(t, x):
        fast = x[2:].reshape(2, 9)
        return np.concatenate([(x[1], -x[0]), fast[1], -(speeds**2) * (fast[0] - 1e-9)])

    solution = Solution(
        rates, 0.0, np.array([1.0, *[0.0] * 19]), accuracy=1e-6, longest=0.04, shortest=1e-10,
        coarsest=coarsest,
    )  # fmt: skip
    while solution.t < 2.0 and solution.steps < 1000:
        solution.step(2.0)
    if most is None:
        assert solution.t < 0.1
        assert solution.damped is None
    else:
        assert solution.x[0] == pytest.approx(np.cos(2.0), abs=1e-6)
        assert solution.damped == (pytest.approx(0.0034, abs=1e-3), pytest.approx(1e-5))
        assert solution.accuracy == 1e-6  # again
