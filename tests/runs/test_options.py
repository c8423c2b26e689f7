import dataclasses
import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import EllipseOptions, LegAOptions, LegBOptions, ScaraOptions
from drake_leg.runs.pendulum_options import (
    DampedPendulumOptions,
    FreePendulumOptions,
    SpringPendulumOptions,
)

NAN, INF = float("nan"), float("inf")


def test_the_defaults_are_the_reports():
    leg = LegBOptions()
    assert (leg.amplitude, leg.frequency, leg.duration) == (0.070, 1.0, 20.0)
    assert leg.q0 == [90.0, -50.0, -90.0]
    assert (leg.l1, leg.l2, leg.l3, leg.density) == (0.050, 0.100, 0.100, 1000.0)
    assert LegAOptions().q0 == [90.0, 50.0, 90.0]
    assert {kind.options().gravity for kind in RUNS.values()} == {9.80665}
    assert FreePendulumOptions().duration == 10.0
    assert DampedPendulumOptions().duration == SpringPendulumOptions().duration == 30.0
    assert DampedPendulumOptions().damping == SpringPendulumOptions().damping == 0.01
    assert SpringPendulumOptions().spring_stiffness == 5.0
    assert SpringPendulumOptions().equilibrium() == math.radians(30.0)
    assert FreePendulumOptions().size == [0.4, 0.01, 0.01]
    assert FreePendulumOptions().density == 1000.0
    assert ScaraOptions().q0 == [30.0, 90.0, -120.0]
    assert (ScaraOptions().tool_height, ScaraOptions().amplitude) == (0.050, 0.050)


@pytest.mark.parametrize("name", RUNS)
def test_every_option_has_a_help_text(name):
    for field in dataclasses.fields(RUNS[name].options):
        assert field.metadata["help"], field.name
        assert "unit" in field.metadata


@pytest.mark.parametrize("name", [name for name in RUNS if name != "hexapod"])
def test_lists_of_one_instance_are_not_those_of_another(name):
    first, second = RUNS[name].options(), RUNS[name].options()
    lists = [n for n, value in dataclasses.asdict(first).items() if isinstance(value, list)]
    assert lists
    for option in lists:
        getattr(first, option).append(7.0)
        assert 7.0 not in getattr(second, option)


@pytest.mark.parametrize("options", [LegBOptions, EllipseOptions, ScaraOptions])
def test_angles_become_radians(options):
    assert options(q0=[180.0, -90.0, 45.0]).posture() == (math.pi, -math.pi / 2, math.pi / 4)


@pytest.mark.parametrize("q0", [[], [1.0], [1.0, 2.0], [1.0, 2.0, 3.0, 4.0], [NAN, 0.0, 0.0],
                                [0.0, INF, 0.0]])  # fmt: skip
def test_a_posture_that_is_not_three_finite_angles_is_refused_with_its_value(q0):
    with pytest.raises(InvalidValueError, match="three finite angles in degrees") as caught:
        LegBOptions(q0=q0).posture()
    assert str(q0) in str(caught.value)


@pytest.mark.parametrize(
    "direction", [[2.0, 0.0, 0.0], [1e-300, 0.0, 0.0], [1e300, 1e300, 0.0], [1.0, -2.0, 3.0]]
)
def test_a_direction_is_brought_to_length_one(direction):
    unit = LegBOptions(direction=direction).unit_direction()
    assert math.hypot(*unit) == pytest.approx(1.0, rel=1e-14)
    greatest = max(direction, key=abs)
    assert unit[direction.index(greatest)] * greatest > 0.0


@pytest.mark.parametrize("direction", [[], [1.0, 0.0], [0.0, 0.0, 0.0], [NAN, 0.0, 1.0],
                                       [INF, 0.0, 0.0]])  # fmt: skip
def test_a_direction_without_a_direction_is_refused_with_its_value(direction):
    with pytest.raises(InvalidValueError) as caught:
        LegBOptions(direction=direction).unit_direction()
    assert str(direction) in str(caught.value)


def test_simscapes_unit_of_damping_is_57_times_as_large():
    si = LegBOptions(damping=0.01).si_damping()
    simscape = LegBOptions(damping=0.01, damping_unit="N*m/(deg/s)").si_damping()
    assert si == 0.01
    assert simscape / si == pytest.approx(180 / math.pi)
    assert simscape / si == pytest.approx(57.3, abs=0.01)


@pytest.mark.parametrize("unit", ["", "Nm/s^2", "Nm/s²", "N*m*s/deg", "n*m*s/rad"])
def test_an_unknown_unit_of_damping_is_refused_with_the_known_ones(unit):
    with pytest.raises(InvalidValueError, match=r"N\*m\*s/rad or N\*m/\(deg/s\)") as caught:
        LegBOptions(damping=0.01, damping_unit=unit).si_damping()
    assert repr(unit) in str(caught.value)


def test_the_integrators_settings_are_passed_on():
    settings = LegBOptions(integrator="radau3", accuracy=1e-5, max_step=0.01)
    chosen = settings.integrator_settings(0.02)
    assert (chosen.scheme, chosen.accuracy, chosen.max_step) == ("radau3", 1e-5, 0.01)
    assert LegBOptions().integrator_settings(0.02).max_step == 0.02
    with pytest.raises(InvalidValueError, match="'warp'"):
        LegBOptions(integrator="warp").integrator_settings(0.02)


def test_an_empty_list_is_not_taken_for_nothing():
    with pytest.raises(InvalidValueError, match="one finite angle"):
        DampedPendulumOptions(q0=[]).start()
    with pytest.raises(InvalidValueError, match="three finite angles"):
        LegBOptions(q0=[]).posture()


def test_a_unit_scales_the_default_and_needs_a_damping():
    scaled = DampedPendulumOptions(damping_unit="N*m/(deg/s)").si_damping()
    assert scaled == pytest.approx(0.01 * 180 / math.pi)
    with pytest.raises(InvalidValueError, match="there is no damping"):
        LegBOptions(damping_unit="N*m/(deg/s)").si_damping()
    assert LegBOptions(damping=0.0, damping_unit="N*m/(deg/s)").si_damping() == 0.0
