"""The benchmarks' own machinery, on clocks that are made up; nothing here is timed."""

import csv
import io
import math

import numpy as np
import pytest
from benchmarks import motion, table
from benchmarks.measure import Contender, Contest, Sample, measure, scaled, timed

PROMISES = {"race": {"tortoise": 4.0}}


def contender(name, seconds, error=0.0):
    """Take the times one after the other; the first is the warm-up's."""
    left = iter([99.0, *seconds])
    return lambda: Contender(name=name, once=lambda: Sample(next(left), error))


def race(ours=0.0, theirs=0.0, **settings):
    contest = Contest(
        name="race",
        work="",
        ours=contender("hare", [3.0, 1.0, 2.0], ours),
        peers=[contender("tortoise", [4.0, 6.0, 5.0], theirs)],
        **settings,
    )
    return measure(contest, 3)


def test_the_best_of_all_repeats_counts_and_the_median_tells_the_spread():
    result = race()
    (peer,) = result.peers
    assert (result.ours.best, peer.best) == (1.0, 4.0)
    assert (result.ours.spread, peer.spread) == (1.0, 0.25)
    assert result.ratio(peer) == 4.0


def test_contenders_take_turns():
    order = []

    def taking_part(name):
        def once():
            order.append(name)
            return Sample(1.0, 0.0)

        return lambda: Contender(name=name, once=once)

    measure(Contest(name="", work="", ours=taking_part("a"), peers=[taking_part("b")]), 2)
    assert order == ["a", "b"] * 3  # the first round warms up


def test_a_time_leaves_out_preparation_and_the_error():
    now = [0.0]

    def lasting(seconds, answer):
        def act(*_):
            now[0] += seconds
            return answer

        return act

    one = timed(
        "one",
        lasting(2.0, "answer"),
        prepare=lasting(10.0, "prepared"),
        error=lasting(100.0, 1e-3),
        clock=lambda: now[0],
    )
    assert one.once() == Sample(2.0, 1e-3)
    assert scaled(one, 5.0).once() == Sample(10.0, 1e-3)


@pytest.mark.parametrize(
    ("ours", "theirs", "enough", "ratio"),
    [(1e-9, 1e-9, 0.0, 4.0), (2e-9, 1e-9, 0.0, None), (2e-9, 1e-9, 3e-9, 4.0)],
)
def test_there_is_no_ratio_where_we_are_less_accurate(ours, theirs, enough, ratio):
    result = race(ours, theirs, enough=enough)
    assert result.ratio(*result.peers) == ratio
    assert ("less accurate" in table.markdown(table.rows_of([result], {}))) == (ratio is None)


def test_a_missing_peer_is_named_with_its_reason():
    def absent():
        raise ModuleNotFoundError("No module named 'absent'")

    contest = Contest(name="race", work="", ours=contender("hare", [1.0]), peers=[absent])
    result = measure(contest, 1)
    assert "No module named 'absent'" in result.missing["absent"]
    assert "skipped: No module" in table.markdown(table.rows_of([result], PROMISES))
    assert list(table.broken([result], PROMISES)) == []


@pytest.mark.parametrize(
    ("least", "errors", "said"),
    [
        (4.0, {}, []),
        (8.0, {}, []),  # half of it is still there
        (8.1, {}, ["race, against tortoise: the ratio is 4, promised are 8.1"]),
        (4.0, {"ours": 1e-9}, ["race, against tortoise: our error is 1e-09, its error 0"]),
        (4.0, {"allowed": 1e-9, "ours": 1e-8, "theirs": 1.0}, ["race: our error is 1e-08, allow"]),
    ],
)
def test_the_check_says_what_is_broken(least, errors, said):
    found = list(table.broken([race(**errors)], {"race": {"tortoise": least}}))
    assert [sentence[: len(start)] for sentence, start in zip(found, said, strict=True)] == said


def test_the_table_in_both_forms():
    rows = list(table.rows_of([race(simulated=20.0, unit="m", theirs=1.5e-9)], PROMISES))
    assert table.markdown(rows).splitlines()[2:] == [
        "| race | **hare** | 1 s | 100% | 20 | 0.0e+00 m |  |  |",
        "|  | tortoise | 4 s | 25% | 5 | 1.5e-09 m | 4 | ≥ 4 |",
    ]
    first, second = csv.DictReader(io.StringIO(table.comma_separated(rows)))
    assert (first["case"], first["contender"]) == ("race", "hare")
    assert (second["case"], second["ratio"], second["promised"]) == ("race", "4", "≥ 4")


def test_only_what_stands_between_the_marks_is_replaced(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{table.BEGIN}\nold\n{table.END}\nafter\n", encoding="utf-8")
    for text in ("new", "newer"):
        table.write_into_page(text, page)
        expected = f"before\n{table.BEGIN}\n\n{text}\n\n{table.END}\nafter\n"
        assert page.read_text(encoding="utf-8") == expected


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (0.00123, "1.2 ms"),
        (0.0123, "12.3 ms"),
        (0.9996, "1 000 ms"),
        (1.5, "1.5 s"),
        (4321, "4 320 s"),
    ],
)
def test_times_have_two_or_three_digits(seconds, said):
    assert table.duration(seconds) == said


def test_the_peers_right_sides_agree_with_differences_of_the_exact_motion(derivative):
    for t in (0.3, 2.0, 4.5):
        q = motion.exact_positions([t])[0]
        qdot = derivative(lambda s: motion.exact_positions([s])[0], at=t)
        qddot = derivative(lambda s: motion.rates_numpy(s, motion.exact_positions([s])[0]), at=t)
        np.testing.assert_allclose(motion.rates(t, q), qdot, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(motion.rates_numpy(t, q), qdot, rtol=0.0, atol=1e-9)
        a = motion.A * motion.W * math.cos(motion.W * t)
        lean = motion.accelerations_at(a, *q, *qdot)
        np.testing.assert_allclose(lean, qddot, rtol=0.0, atol=1e-8)
        np.testing.assert_allclose(motion.accelerations(t, q, qdot), qddot, rtol=0.0, atol=1e-8)


def test_the_docs_promise_what_ci_checks_and_the_measured_table_keeps_it():
    lines = table.PAGE.read_text(encoding="utf-8").splitlines()
    shown, case, cases = {}, None, set()
    for line in lines:
        row = [part.strip() for part in line.split("|")[1:-1]]
        if len(row) != len(table.HEADS):
            continue
        case = row[0] or case
        cases.add(case)
        if row[-1].startswith("≥"):
            shown.setdefault(case, {})[row[1]] = float(row[-1].removeprefix("≥"))
            assert float(row[-2].replace(" ", "")) >= shown[case][row[1]], line
    promises = table.read_promises()
    assert shown == {case: least for case, least in promises.items() if case in cases}
    assert shown
