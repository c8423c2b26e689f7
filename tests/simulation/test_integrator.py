import pytest
from pydrake.systems.analysis import (
    GetIntegrationSchemes,
    ResetIntegratorFromFlags,
    Simulator,
)
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, Integrator

from drake_leg.errors import InvalidValueError
from drake_leg.simulation.integrator import (
    ERROR_CONTROLLED,
    INTEGRATORS,
    ROW_INTERVAL,
    IntegratorSettings,
)

NAN, INF = float("nan"), float("inf")


def test_fixed_steps_of_runge_kutta_5_at_40_ms_are_the_default():
    settings = IntegratorSettings()
    assert settings.scheme == "runge_kutta5"
    assert settings.accuracy is None
    assert settings.max_step == ROW_INTERVAL == 0.040


@pytest.mark.parametrize("scheme", INTEGRATORS)
def test_drake_knows_every_integrator(scheme):
    assert scheme in GetIntegrationSchemes()
    IntegratorSettings(scheme=scheme)


@pytest.mark.parametrize("scheme", INTEGRATORS)
def test_those_with_error_control_are_the_ones_that_drake_gives_it(scheme):
    builder = DiagramBuilder()
    source = builder.AddSystem(ConstantVectorSource([1.0]))
    integrator = builder.AddSystem(Integrator(1))
    builder.Connect(source.get_output_port(), integrator.get_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, scheme, 0.01)
    fixed = simulator.get_integrator().get_fixed_step_mode()  # always, where nothing is estimated
    assert fixed == (scheme not in ERROR_CONTROLLED)


@pytest.mark.parametrize("scheme", ["", "RK5", "runge_kutta4", "runge_kutta5 ", None])
def test_an_unknown_integrator_is_refused_with_the_names_of_the_known(scheme):
    with pytest.raises(InvalidValueError, match="runge_kutta5, runge_kutta3") as caught:
        IntegratorSettings(scheme=scheme)
    assert repr(scheme) in str(caught.value)


@pytest.mark.parametrize("step", [0.0, -0.01, NAN, INF, 0.0401, 1.0])
def test_a_step_that_is_not_positive_or_too_large_for_the_rows_is_refused(step):
    with pytest.raises(InvalidValueError, match=f"greatest step is {step}"):
        IntegratorSettings(max_step=step)


@pytest.mark.parametrize("accuracy", [0.0, -1e-6, NAN, INF, 0.2, 1e-15])
def test_an_accuracy_out_of_range_is_refused(accuracy):
    with pytest.raises(InvalidValueError, match=f"accuracy is {accuracy}"):
        IntegratorSettings(accuracy=accuracy)


@pytest.mark.parametrize("scheme", sorted(set(INTEGRATORS) - set(ERROR_CONTROLLED)))
def test_an_accuracy_for_an_integrator_without_error_control_is_refused(scheme):
    with pytest.raises(InvalidValueError, match=f"'{scheme}' has no error control"):
        IntegratorSettings(scheme=scheme, accuracy=1e-6)


@pytest.mark.parametrize("scheme", ERROR_CONTROLLED)
@pytest.mark.parametrize("accuracy", [1e-14, 1e-6, 0.1])
def test_error_controlled_integrators_take_an_accuracy(scheme, accuracy):
    assert IntegratorSettings(scheme=scheme, accuracy=accuracy).accuracy == accuracy
