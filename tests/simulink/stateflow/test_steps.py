"""Steps of charts, against what Stateflow's documentation says of their order."""

import pytest
from chart_drawings import Drawing

from drake_leg.errors import InvalidValueError

NOTHING = ((),) * 12


def switched(**more):
    """A chart that is on above 1 and off below 0."""
    made = Drawing(**more)
    made.data("INPUT", "u")
    made.data("OUTPUT", "y")
    made.state("Off", "\nentry: y = 0;")
    made.state("On", "\nen: y = 1;")
    made.way("", "Off")
    made.way("Off", "On", "[u > 1]")
    made.way("On", "Off", "[u < 0]")
    return made


def log(*, parallel=False):
    """A chart that writes the digits of what it does into y."""
    made = Drawing(parallel=parallel)
    made.data("OUTPUT", "y")
    return made


def digits(number):
    return f"y = 10*y + {number};"


@pytest.mark.parametrize("language", ["2", ""])
def test_a_state_is_kept_until_a_condition_lets_it_go(language):
    steps = switched(language=language).steps((5.0,), (5.0,), (0.5,), (-1.0,), (0.5,), (2.0,))
    assert [y for (y,) in steps] == [0, 1, 1, 0, 0, 1]


def test_the_first_step_enters_and_goes_no_further_unless_it_is_told():
    made = switched(executeAtInitialization="1")
    assert made.steps((5.0,)) == [(1.0,)]


def test_what_has_no_keyword_is_done_at_entry_and_during():
    made = Drawing()
    made.data("OUTPUT", "y")
    made.state("A", "\ny = y + 1;\nexit: y = -100;")
    made.state("B", "\ndu, ex: y = y + 5;")
    made.way("", "A")
    made.way("A", "B", "[y == 3]")
    assert [y for (y,) in made.steps(*NOTHING[:6])] == [1, 2, 3, -100, -95, -90]


def test_exits_come_from_inside_and_entries_from_outside():
    """1: exit of the inner state, 2: of the outer one, 3: the transition, 4 and 5: entries."""
    made = log()
    made.state("A", f"\nexit: {digits(2)}")
    made.state("A1", f"\nexit: {digits(1)}", within="A")
    made.way("", "A1", within="A")
    made.state("B", f"\nentry: {digits(4)}")
    made.state("B1", f"\nentry: {digits(5)}", within="B")
    made.way("", "B1", within="B")
    made.way("", "A")
    made.way("A", "B", f"/{digits(3)}")
    assert made.steps(*NOTHING[:2]) == [(0.0,), (12345.0,)]


def test_an_outer_transition_comes_before_during_and_during_before_what_is_inside():
    made = log()
    made.state("A", f"\nduring: {digits(1)}")
    made.state("A1", "", within="A")
    made.state("A2", f"\nentry: {digits(3)}", within="A")
    made.way("", "A1", within="A")
    made.way("A1", "A2", f"{{{digits(2)}}}", within="A")
    made.state("B", f"\nentry: {digits(9)}")
    made.way("", "A")
    made.way("A", "B", "[y > 100]")
    assert [y for (y,) in made.steps(*NOTHING[:3])] == [0, 123, 1239]


def test_an_inner_transition_does_not_leave_its_state():
    made = log()
    made.state("A", f"\nentry: {digits(8)}\nexit: {digits(9)}")
    made.state("A1", f"\nexit: {digits(1)}", within="A")
    made.state("A2", f"\nentry: {digits(2)}", within="A")
    made.way("", "A1", within="A")
    made.way("A", "A2", "[y == 8]", within="A")
    made.way("", "A")
    assert [y for (y,) in made.steps(*NOTHING[:3])] == [8, 812, 812]


def test_a_way_back_to_its_own_state_leaves_and_enters_it():
    made = log()
    made.state("A", f"\nentry: {digits(1)}\nexit: {digits(2)}")
    made.way("", "A")
    made.way("A", "A")
    assert [y for (y,) in made.steps(*NOTHING[:3])] == [1, 121, 12121]


def test_transitions_are_tried_in_their_order():
    made = log()
    for name, number in (("A", 1), ("B", 2), ("C", 3)):
        made.state(name, f"\nentry: y = {number};")
    made.way("", "A")
    made.way("A", "B", "[true]", order=2)
    made.way("A", "C", "[true]", order=1)
    assert made.steps(*NOTHING[:2])[-1] == (3.0,)


def test_a_condition_action_is_done_at_once_and_a_transition_action_when_it_is_taken():
    """The first way through the junction fails behind it: only its condition action is done."""
    made = log()
    for name in ("A", "B", "C"):
        made.state(name)
    made.junction("J")
    made.way("", "A")
    made.way("A", "J", f"{{{digits(1)}}}/{digits(7)}", order=1)
    made.way("J", "B", "[false]", order=1)
    made.way("A", "C", f"[true]{{{digits(2)}}}/{digits(3)}", order=2)
    assert made.steps(*NOTHING[:2])[-1] == (123.0,)


def test_a_way_that_ends_at_a_junction_stops_the_search_and_leaves_nothing():
    made = log()
    made.state("A", f"\nduring: {digits(2)}")
    made.state("B", f"\nentry: {digits(9)}")
    made.junction("J")
    made.way("", "A")
    made.way("A", "J", f"{{{digits(1)}}}", order=1)
    made.way("A", "B", "", order=2)
    assert made.steps(*NOTHING[:2])[-1] == (12.0,)


def test_parallel_states_act_in_their_order():
    made = log(parallel=True)
    made.state("Second", f"\ndu: {digits(2)}", order=2)
    made.state("First", f"\ndu: {digits(1)}", order=1)
    assert [y for (y,) in made.steps(*NOTHING[:3])] == [0, 12, 1212]


def test_a_way_out_of_parallel_states_ends_all_of_them():
    made = log()
    made.state("P", f"\nexit: {digits(5)}", parallel=True)
    made.state("First", f"\nexit: {digits(4)}", within="P", order=1)
    made.state("Second", f"\ndu: {digits(9)}\nexit: {digits(3)}", within="P", order=2)
    made.state("End", f"\nentry: {digits(6)}")
    made.way("", "P")
    made.way("First", "End")
    assert made.steps(*NOTHING[:2])[-1] == (3456.0,)


def test_a_way_into_a_parallel_state_enters_the_others_too():
    made = log()
    made.state("A")
    made.state("P", parallel=True)
    made.state("First", "", within="P", order=1)
    made.state("F1", f"\nentry: {digits(1)}", within="First")
    made.state("F2", f"\nentry: {digits(2)}", within="First")
    made.way("", "F1", within="First")
    made.state("Second", f"\nentry: {digits(3)}", within="P", order=2)
    made.way("", "A")
    made.way("A", "F2")
    assert made.steps(*NOTHING[:2])[-1] == (23.0,)


@pytest.mark.parametrize(
    ("wait", "at"),
    [
        ("after(0.3, sec)", 3),
        ("after(300, msec)", 3),
        ("[after(0.3, sec) && true]", 3),
        ("[elapsed(sec) > 0.25]", 3),
        ("after(4, tick)", 4),
        ("[temporalCount(tick) >= 4]", 4),
        ("at(2, tick)", 2),
        ("every(5, tick)", 5),
    ],
)
def test_time_is_counted_from_the_entry(wait, at):
    made = Drawing()
    made.data("OUTPUT", "y")
    made.state("A", "\nentry: y = 0;")
    made.state("B", "\nentry: y = 1;")
    made.way("", "A")
    made.way("A", "B", wait)
    made.way("B", "A", wait)
    found = [y for (y,) in made.steps(*NOTHING)]
    assert found == [(step // at) % 2 for step in range(len(NOTHING))]


def test_before_holds_until_a_time():
    made = Drawing()
    made.data("INPUT", "u")
    made.data("OUTPUT", "y")
    made.state("A")
    made.state("B", "\nentry: y = 1;")
    made.way("", "A")
    made.way("A", "B", "before(0.25, sec)[u > 0]")
    assert made.steps((0.0,), (0.0,), (1.0,))[-1] == (1.0,)
    assert made.steps((0.0,), (0.0,), (0.0,), (1.0,))[-1] == (0.0,)


def test_a_chart_asks_for_the_state_of_another_part():
    made = log(parallel=True)
    made.state("Motor", "", order=1)
    made.state("Idle", "", within="Motor")
    made.state("Busy", "", within="Motor")
    made.way("", "Idle", within="Motor")
    made.way("Idle", "Busy", within="Motor")
    made.state("Lamp", "\ndu: y = 1 + in(Motor.Busy);", order=2)
    assert [y for (y,) in made.steps(*NOTHING[:2])] == [0, 2]


def test_a_function_of_a_chart_reads_its_data():
    made = Drawing()
    made.data("INPUT", "u")
    made.data("OUTPUT", "y")
    made.data("LOCAL", "most", initial="3")
    made.function("r = limited", "function r = limited\nr = min(u, most);")
    made.state("A", "\ny = limited;")
    made.way("", "A")
    assert made.steps((2.0,), (7.0,)) == [(2.0,), (3.0,)]


def test_actions_of_c_are_translated():
    made = Drawing(language="")
    made.data("INPUT", "u")
    made.data("OUTPUT", "y")
    made.data("LOCAL", "n", initial="5")
    made.state("A", "/ y = 1; /* off */\nduring: n++; y += 2*n; // both")
    made.state("B", "\nentry: n -= 3; y = n + t;")
    made.way("", "A")
    made.way("A", "B", "[!(u != 1) & n > 6]")
    found = made.steps((0.0,), (0.0,), (1.0,), (1.0,))
    assert [y for (y,) in found] == pytest.approx([1.0, 13.0, 27.0, 4.0 + 0.3])


def test_indices_of_c_count_from_zero():
    made = Drawing(language="")
    made.data("OUTPUT", "y")
    made.data("LOCAL", "n", initial="1")
    made.data("LOCAL", "A", initial="[1 2; 3 4]")
    made.data("LOCAL", "v", initial="[5 6 7]")
    made.state("A1", "\nentry: v[n] = 60; y = A[0][1] + 10*v[n] + 100*v[n + n];")
    made.way("", "A1")
    assert made.steps(()) == [(2.0 + 600.0 + 700.0,)]


def test_data_have_their_sizes_and_types():
    made = Drawing()
    made.data("INPUT", "u")
    made.data("OUTPUT", "y", "z", "s")
    made.data("LOCAL", "v", initial="2", size="3")
    made.data("LOCAL", "k", type="int8")
    made.data("LOCAL", "b", type="boolean")
    made.state("A", "\nk = 100*u; b = u; y = k; z = b; s = sum(v); v(2) = 5;")
    made.way("", "A")
    made.state("B", "\nentry: y = k; z = b;")
    made.way("A", "B")
    assert made.steps((1.3,), (0.0,)) == [(130.0, 1.3, 6.0), (127.0, 1.0, 6.0)]


def test_names_of_data_are_left_to_them():
    made = Drawing()
    made.data("OUTPUT", "at_chart", "took_0")
    made.state("A", "\nat_chart = at_chart + 5; took_0 = 9;")
    made.way("", "A")
    made.state("B", "\nentry: at_chart = 50;")
    made.way("A", "B", "[at_chart > 7]")
    assert made.steps(*NOTHING[:3]) == [(5.0, 9.0), (10.0, 9.0), (50.0, 9.0)]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.way("On", "Off", "tripped", order=2), "waits for the event 'tripped'"),
        (lambda c: c.add('<event name="go"/>'), "has the event 'go'"),
        (lambda c: c.add('<event><P Name="name">go</P></event>'), "has the event 'go'"),
        (lambda c: c.junction("H", kind="HISTORY_JUNCTION"), "has a history junction"),
        (lambda c: c.state("P", "\non go: y = 1;"), r"'on go:' in its state 'P'.* transition"),
        (lambda c: c.state("P", "\nentry: send(go);"), "calls 'send'"),
        (lambda c: c.state("Box", kind="GROUP_STATE") or c.state("In", within="Box"), "box 'Box'"),
        (lambda c: c.function("r = drawn(u)", ""), r"function 'r = drawn\(u\)', which is drawn"),
        (lambda c: c.state("In", within="On"), "no default transition in 'On': draw one"),
        (lambda c: c.way("On", "Off", "[u < 3"), r"close a bracket: '\[u < 3'"),
        (lambda c: c.way("On", "Off", "[u < 3]"), "without an order: number them"),
        (lambda c: c.way("On", "Off", "after(2, go)", order=2), r"after\(2, go\), .* seconds or"),
        (lambda c: c.way("On", "Off", "[in(Away)]", order=2), "'Away', of which it has 0"),
        (lambda c: c.data("LOCAL", "e", type="Enum: Color"), "'e' of the type 'Enum: Color'"),
        (lambda c: c.way("On", "", "[u < 3]", order=2), "leads nowhere"),
    ],
)  # fmt: skip
def test_what_does_not_run_is_said(change, message):
    made = switched()
    change(made)
    if "Box" in message or "'P'" in message or "send" in message:
        made.way("On", "P" if "Box" not in message else "In", "[u > 8]", order=3)
    with pytest.raises(InvalidValueError, match=message):
        made.code()


def test_junctions_that_lead_back_are_said():
    made = switched()
    made.junction("J")
    made.junction("K")
    made.way("On", "J", order=2)
    made.way("J", "K")
    made.way("K", "J")
    with pytest.raises(InvalidValueError, match="junctions that lead back to themselves"):
        made.code()


def test_a_net_of_junctions_ends_with_a_sentence():
    made = switched()
    for level in range(39):
        made.junction(f"J{level}")
        for order in (1, 2):
            made.way(f"J{level - 1}" if level else "On", f"J{level}", order=order + 1)
    made.way("J38", "Off")
    with pytest.raises(InvalidValueError, match="more than 20000 lines of code"):
        made.code()


def test_a_chart_of_very_many_states_ends_with_a_sentence():
    made = switched()
    for number in range(2001):
        made.state(f"S{number}")
    with pytest.raises(InvalidValueError, match="more than 2000 states"):
        made.code()
