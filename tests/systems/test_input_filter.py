import numpy as np
import pytest
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, Sine, VectorLogSink

from drake_leg.errors import InvalidValueError
from drake_leg.systems.input_filter import InputFilter

TAU = 0.05  # [s]


def filtered(source, block, duration=1.0, *, start=True):
    """Feed a source to a filter; return time and the filter's outputs."""
    builder = DiagramBuilder()
    source = builder.AddNamedSystem("source", source)
    builder.AddNamedSystem("filter", block)
    builder.Connect(source.get_output_port(0), block.get_input_port())
    logs = []
    for index in range(block.num_output_ports()):
        port = block.get_output_port(index)
        logs.append(builder.AddNamedSystem(port.get_name(), VectorLogSink(port.size())))
        builder.Connect(port, logs[-1].get_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "runge_kutta5", 0.002)
    simulator.get_mutable_integrator().set_fixed_step_mode(True)
    root = simulator.get_mutable_context()
    if start:
        block.start_from_input(block.GetMyMutableContextFromRoot(root))
    simulator.AdvanceTo(duration)
    found = [log.FindLog(root) for log in logs]
    return found[0].sample_times(), *(log.data().T for log in found)


def test_the_answer_to_a_step_is_that_of_two_lags_in_series():
    block = InputFilter(2, TAU, initial=[1.0, -2.0])
    time, q, qdot, qddot = filtered(ConstantVectorSource([3.0, 5.0]), block, start=False)
    s, step = time[:, np.newaxis] / TAU, np.array([2.0, 7.0])
    decay = np.exp(-s)
    kwargs = {"rtol": 0, "atol": 1e-8}
    np.testing.assert_allclose(q, [1.0, -2.0] + step * (1 - (1 + s) * decay), **kwargs)
    np.testing.assert_allclose(qdot, step * s * decay / TAU, **kwargs)
    np.testing.assert_allclose(qddot, step * (1 - s) * decay / TAU**2, rtol=0, atol=1e-5)


def test_the_answer_to_a_step_is_that_of_one_lag():
    block = InputFilter(1, TAU, order=1, initial=[1.0])
    time, q, qdot = filtered(ConstantVectorSource([3.0]), block, start=False)
    decay = np.exp(-time / TAU)
    np.testing.assert_allclose(q[:, 0], 3.0 - 2.0 * decay, rtol=0, atol=1e-8)
    np.testing.assert_allclose(qdot[:, 0], 2.0 * decay / TAU, rtol=0, atol=1e-6)


@pytest.mark.parametrize("order", [1, 2])
def test_a_sine_comes_out_smaller_and_late_by_the_lags_phase(order):
    w = 7.0
    block = InputFilter(1, TAU, order=order)
    time, *outputs = filtered(Sine(1.0, w, 0.0, 1), block, duration=3.0)
    answer = (1.0 / (1.0 + 1j * w * TAU)) ** order
    late = time > 2.0
    for derivative, found in enumerate(outputs):
        wanted = ((1j * w) ** derivative * answer * np.exp(1j * w * time)).imag
        np.testing.assert_allclose(found[late, 0], wanted[late], rtol=0, atol=1e-6)


def test_it_starts_at_rest_at_its_inputs_own_value():
    _, q, qdot, qddot = filtered(ConstantVectorSource([0.3, -0.4]), InputFilter(2), duration=0.05)
    np.testing.assert_allclose(q, np.tile([0.3, -0.4], (len(q), 1)), rtol=0, atol=1e-15)
    assert np.abs(qdot).max() < 1e-12
    assert np.abs(qddot).max() < 1e-9


def test_only_the_highest_derivative_passes_the_input_straight_on():
    for order in (1, 2):
        block = InputFilter(1, order=order)
        straight = [block.HasDirectFeedthrough(0, i) for i in range(block.num_output_ports())]
        assert straight == [False] * order + [True]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"time_constant": 0.0}, "time constant is 0.0 s"),
        ({"time_constant": float("nan")}, "time constant is nan s"),
        ({"order": 3}, "order is 3; it must be 1 or 2"),
        ({"initial": [1.0]}, r"initial output is \[1.0\]; it must be 2 finite numbers"),
        ({"initial": [1.0, float("inf")]}, "inf.*must be 2 finite numbers"),
    ],
)
def test_senseless_filters_are_refused(changes, words):
    with pytest.raises(InvalidValueError, match=words):
        InputFilter(2, **changes)
