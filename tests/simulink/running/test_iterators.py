"""Subsystems that iterate, against sums and filters by hand."""

import numpy as np
import pytest
from rigs import Rig, shown
from scipy import signal

from drake_leg.errors import InvalidValueError

STEP = 0.1  # [s]


def system_of(rig, iterator, inputs=0, **parameters):
    """A subsystem with an iterator, whose ports are connected by hand."""
    system = rig.add_block("SubSystem", "loop", ports={"in": inputs, "out": 1})
    ports = {"in": 2, "out": 1} if iterator == "WhileIterator" else {"in": 1, "out": 1}
    inner = rig.add_block(iterator, "iterator", parameters, system=system, ports=ports)
    return system, inner


def entry(rig, system, source, number=1, **parameters):
    inside = rig.add_block("Inport", f"in {number}", {"Port": f"{number}", **parameters},
                           system=system, ports={"out": 1})  # fmt: skip
    rig.connect(source, f"{system}#in:{number}")
    return inside


def led_out(rig, system, source, **parameters):
    out = rig.add_block("Outport", "out", {"Port": "1", **parameters}, system=system,
                        ports={"in": 1})  # fmt: skip
    rig.connect(source, out)


def summed(rig, system, source, start="0"):
    """A sum over the iterations, and over the steps where states are held."""
    total = rig.block("Sum", "total", source, "", Inputs="++", system=system)
    before = rig.block("UnitDelay", "before", total, InitialCondition=start, SampleTime="-1",
                       system=system)  # fmt: skip
    rig.connect(before, f"{total}#in:2")
    return total


def off_samples(run):
    """The number of the last sample of each row, and which rows are between samples."""
    k = np.floor(run.time / STEP + 1e-6).astype(int)
    return k, np.abs(run.time / STEP - np.round(run.time / STEP)) > 1e-6


@pytest.mark.parametrize(
    ("mode", "expected"), [("One-based", 1 + 4 + 9 + 16), ("Zero-based", 0 + 1 + 4 + 9)]
)
def test_squares_are_summed_up_from_the_start_at_each_step(mode, expected, tmp_path):
    rig = Rig()
    system, i = system_of(rig, "ForIterator", IterationLimit="4", ResetStates="reset",
                          IndexMode=mode)  # fmt: skip
    square = rig.block("Math", "square", i, Operator="square", system=system)
    led_out(rig, system, summed(rig, system, square))
    rig.show(system, "y")
    assert np.all(shown(rig.run(tmp_path), "y") == expected)


def test_held_states_go_on_at_the_next_sample(tmp_path):
    """Three times a sample: n = 3, 6, 9, ..."""
    rig = Rig()
    one = rig.block("ZeroOrderHold", "one", rig.constant("1"), SampleTime=f"{STEP}")
    system, _ = system_of(rig, "ForIterator", 1, IterationLimit="3", ResetStates="held")
    led_out(rig, system, summed(rig, system, entry(rig, system, one)))
    rig.show(system, "n")
    run = rig.run(tmp_path)
    k, off = off_samples(run)
    np.testing.assert_array_equal(shown(run, "n")[off], 3.0 * (k[off] + 1))


def test_a_signal_is_iterated_as_it_is_at_each_instant(tmp_path):
    """Newton's method for a square root."""
    rig = Rig()
    u = rig.block("Bias", "more", rig.block("Clock", "clock"), Bias="1")
    system, _ = system_of(rig, "ForIterator", 1, IterationLimit="6", ResetStates="reset")
    a = entry(rig, system, u)
    before = rig.block("UnitDelay", "before", "", InitialCondition="1", SampleTime="-1",
                       system=system)  # fmt: skip
    share = rig.block("Product", "share", a, before, Inputs="*/", system=system)
    total = rig.block("Sum", "total", before, share, Inputs="++", system=system)
    half = rig.block("Gain", "half", total, Gain="0.5", system=system)
    rig.connect(half, f"{before}#in:1")
    led_out(rig, system, half)
    rig.show(system, "y")
    rig.show(rig.block("Integrator", "x", system), "x")
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "y"), np.sqrt(run.time + 1.0), atol=1e-9)
    expected = 2.0 / 3.0 * ((run.time + 1.0) ** 1.5 - 1.0)
    np.testing.assert_allclose(shown(run, "x"), expected, atol=1e-8)


@pytest.mark.parametrize(("values", "expected"), [("[2 3 5]", 10.0), ("7", 7.0)])
def test_the_number_of_iterations_may_be_the_width_of_what_comes_in(values, expected, tmp_path):
    rig = Rig()
    system, i = system_of(rig, "ForIterator", 1, IterationSource="external", ResetStates="reset")
    u = entry(rig, system, rig.constant(values))
    rig.connect(rig.block("Width", "width", u, system=system), i)
    one = rig.block("Selector", "one", u, i, IndexOptions="Index vector (port)",
                    InputPortWidth="-1", system=system)  # fmt: skip
    led_out(rig, system, summed(rig, system, one))
    rig.show(system, "y")
    assert np.all(shown(rig.run(tmp_path), "y") == expected)


def test_without_an_iteration_a_subsystem_holds_what_it_put_out(tmp_path):
    rig = Rig()
    count = rig.block("Step", "count", Time="0.45", Before="2", After="0", SampleTime=f"{STEP}")
    system, i = system_of(rig, "ForIterator", 1, IterationSource="external")
    rig.connect(entry(rig, system, count), i)
    clock = rig.block("DigitalClock", "clock", SampleTime="-1", system=system)
    led_out(rig, system, clock)
    rig.show(system, "y")
    run = rig.run(tmp_path)
    k, off = off_samples(run)
    np.testing.assert_allclose(shown(run, "y")[off], np.minimum(k[off], 4.0) * STEP, atol=1e-12)


@pytest.mark.parametrize(
    ("how", "start", "most", "expected"),
    [("while", "1", "50", 55.0), ("do-while", "", "50", 55.0), ("while", "0", "50", 0.0),
     ("do-while", "", "4", 10.0)],
)  # fmt: skip
def test_a_sum_grows_while_it_is_small(how, start, most, expected, tmp_path):
    """1 + 2 + ... is the first above 50 after the tenth iteration."""
    rig = Rig()
    system, i = system_of(rig, "WhileIterator", 1 if start else 0, WhileBlockType=how,
                          MaxIters=most, ResetStates="reset")  # fmt: skip
    if start:
        rig.connect(entry(rig, system, rig.constant(start)), f"{i}#in:2")
    total = summed(rig, system, i)
    limit = rig.block("Constant", "limit", Value="50", system=system)
    small = rig.block("RelationalOperator", "small", total, limit, Operator="<=", system=system)
    rig.connect(small, f"{i}#in:1")
    led_out(rig, system, total)
    rig.show(system, "y")
    assert np.all(shown(rig.run(tmp_path), "y") == expected)


def test_an_enabled_subsystem_is_within_an_iteration(tmp_path):
    """Odd numbers are summed up, even ones are not: 1 + 3 + 5."""
    rig = Rig()
    system, i = system_of(rig, "ForIterator", IterationLimit="6", ResetStates="reset")
    two = rig.block("Constant", "two", Value="2", system=system)
    rest = rig.block("Math", "rest", i, two, Operator="mod", system=system)
    gated = rig.add_block("SubSystem", "odd", ports={"in": 1, "out": 1, "enable": 1}, system=system)
    rig.add_block("EnablePort", "gate", system=gated)
    rig.connect(rest, f"{gated}#enable")
    inside = entry(rig, gated, i)
    led_out(rig, gated, summed(rig, gated, inside))
    led_out(rig, system, gated)
    rig.show(system, "y")
    assert np.all(shown(rig.run(tmp_path), "y") == 9.0)


def each(rig, u, block, width="1", **more):
    """A For Each subsystem around one block that a function draws."""
    system = rig.add_block("SubSystem", "each", ports={"in": 1, "out": 1})
    rig.add_block("ForEach", "for each", more, system=system)
    part = entry(rig, system, u, Partition="on", PartitionDimension="1", PartitionWidth=width,
                 PartitionOffset="0")  # fmt: skip
    led_out(rig, system, block(system, part), ConcatenationDimension="1")
    return system


def test_each_part_has_states_of_its_own(tmp_path):
    """A lag of each of three numbers, and a sum of samples of each."""
    rig = Rig()
    u = rig.constant("[1 2 -3]")

    def lag(system, part):
        return rig.block("TransferFcn", "lag", part, Numerator="[1]", Denominator="[0.2 1]",
                         system=system)  # fmt: skip

    def total(system, part):
        return rig.block("DiscreteIntegrator", "sum", part, gainval="10", SampleTime="-1",
                         system=system)  # fmt: skip

    sampled = rig.block("ZeroOrderHold", "hold", u, SampleTime=f"{STEP}")
    rig.show(each(rig, u, lag), "y")
    rig.show(each(rig, sampled, total), "n")
    run = rig.run(tmp_path)
    parts = np.array([1.0, 2.0, -3.0])
    expected = (1.0 - np.exp(-run.time / 0.2))[:, None] * parts
    np.testing.assert_allclose(shown(run, "y"), expected, atol=1e-7)
    k, off = off_samples(run)
    np.testing.assert_allclose(shown(run, "n")[off], (k[:, None] * parts)[off], atol=1e-9)


def test_parts_of_several_numbers_are_joined_again(tmp_path):
    rig = Rig()

    def most(system, part):
        return rig.block("MinMax", "most", part, Function="max", Inputs="1", system=system)

    rig.show(each(rig, rig.constant("[1 2 3 4 6 5]"), most, width="2"), "y")
    assert np.array_equal(rig.values(tmp_path)["y"], [2.0, 4.0, 6.0])


def test_a_delay_outside_of_it_closes_a_loop(tmp_path):
    rig = Rig()
    held = rig.block("UnitDelay", "before", "", InitialCondition="[1 2]", SampleTime=f"{STEP}")

    def half(system, part):
        return rig.block("Gain", "half", part, Gain="0.5", system=system)

    system = each(rig, held, half)
    rig.connect(system, f"{held}#in:1")
    rig.show(system, "y")
    run = rig.run(tmp_path)
    k, off = off_samples(run)
    factor = signal.lfilter([0.5], [1.0, -0.5], np.eye(1, 12).ravel())[k[off]]
    np.testing.assert_allclose(shown(run, "y")[off], factor[:, None] * [1.0, 2.0], atol=1e-12)


def test_the_index_of_a_part_is_put_out(tmp_path):
    rig = Rig()
    system = rig.add_block("SubSystem", "each", ports={"in": 1, "out": 1})
    shows = {"ShowIterationIndex": "on", "IndexMode": "One-based"}
    index = rig.add_block("ForEach", "for each", shows, system=system, ports={"out": 1})
    part = entry(rig, system, rig.constant("[5 7 9]"), Partition="on")
    led_out(rig, system, rig.block("Product", "times", part, index, Inputs="2", system=system))
    rig.show(system, "y")
    assert np.array_equal(rig.values(tmp_path)["y"], [5.0, 14.0, 27.0])


def test_parts_that_do_not_fit_are_refused(tmp_path):
    rig = Rig()

    def same(system, part):
        return rig.block("Gain", "same", part, Gain="1", system=system)

    rig.show(each(rig, rig.constant("[1 2 3]"), same, width="2"), "y")
    with pytest.raises(InvalidValueError, match="takes parts of 2 out of 3: let them fit"):
        rig.code(tmp_path)


@pytest.mark.parametrize(
    ("iterator", "parameters", "message"),
    [
        ("ForIterator", {"ExternalIncrement": "on"}, "has ExternalIncrement 'on', which does not"),
        ("WhileIterator", {"MaxIters": "-1"}, "may iterate without end"),
        ("ForEach", {"StateHandling": "Share"}, "has StateHandling 'Share', which does not run"),
    ],
)
def test_options_that_do_not_run_are_refused(iterator, parameters, message, tmp_path):
    rig = Rig()
    system, _ = system_of(rig, iterator, **parameters)
    led_out(rig, system, rig.block("Constant", "one", Value="1", system=system))
    rig.show(system, "y")
    with pytest.raises(InvalidValueError, match=message):
        rig.code(tmp_path)


def test_what_is_integrated_is_not_iterated(tmp_path):
    rig = Rig()
    system, i = system_of(rig, "ForIterator")
    led_out(rig, system, rig.block("Integrator", "x", i, system=system))
    rig.show(system, "y")
    with pytest.raises(InvalidValueError, match="iterates what is integrated"):
        rig.code(tmp_path)


def test_iterations_in_iterations_are_refused(tmp_path):
    rig = Rig()
    system, i = system_of(rig, "ForIterator")
    inner = rig.add_block("SubSystem", "inner", ports={"out": 1}, system=system)
    k = rig.add_block("ForIterator", "inner iterator", system=inner, ports={"out": 1})
    led_out(rig, inner, k)
    led_out(rig, system, rig.block("Sum", "both", i, inner, Inputs="++", system=system))
    rig.show(system, "y")
    with pytest.raises(InvalidValueError, match=r"'inner iterator' .* iterates within another"):
        rig.code(tmp_path)
