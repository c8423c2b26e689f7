import numpy as np
import pytest

from drake_leg.scene.live import MOST_PIECES, Trace

AHEAD = np.array([1.0, 0.0, 0.0])


def gone(trace, *places):
    for place in places:
        trace.add(place * AHEAD)
    return trace


def test_pieces_follow_each_other_and_short_ones_wait():
    trace = gone(Trace(1.0), 0.0, 0.001, 0.1, 0.101, 0.2)
    news = trace.since(-1, 0)
    assert news["pieces"] == [
        pytest.approx([0.0, 0, 0, 0.1, 0, 0]),
        pytest.approx([0.1, 0, 0, 0.2, 0, 0]),
    ]


def test_only_what_is_new_is_told():
    trace = gone(Trace(1.0), 0.0, 0.1)
    first = trace.since(-1, 0)
    assert trace.since(first["cleared"], first["count"])["pieces"] == []
    gone(trace, 0.2)
    assert len(trace.since(first["cleared"], first["count"])["pieces"]) == 1
    assert len(trace.since(-1, 0)["pieces"]) == 2


def test_a_tip_that_is_put_elsewhere_draws_no_chord():
    trace = gone(Trace(1.0), 0.0, 0.1)
    trace.lift()
    gone(trace, 5.0, 5.1)
    ends = [piece[0] for piece in trace.since(-1, 0)["pieces"]]
    assert ends == [0.0, 5.0]


def test_a_cleared_trace_begins_where_the_tip_is():
    trace = gone(Trace(1.0), 0.0, 0.1)
    told = trace.since(-1, 0)
    trace.clear()
    news = gone(trace, 0.7, 0.8).since(told["cleared"], told["count"])
    assert news["cleared"] != told["cleared"]
    assert [piece[0] for piece in news["pieces"]] == [0.7]


def test_the_oldest_pieces_go():
    trace = gone(Trace(1.0), *np.arange(MOST_PIECES + 50.0))
    news = trace.since(-1, 0)
    assert (news["count"], len(news["pieces"])) == (MOST_PIECES + 49, MOST_PIECES)
    assert news["pieces"][-1][3] == MOST_PIECES + 49.0
