import math
import time
from threading import Thread

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.scene.live import MOST_PIECES, Feed, Trace, action_of, numbers_of, tab_of


def test_a_command_says_what_to_do():
    assert action_of({"do": "halt"}, ("halt", "quit")) == "halt"
    for wanted in ("jump", None, 3, ["halt"], {}):
        with pytest.raises(InvalidValueError, match='"do" must be one of halt, quit'):
            action_of({"do": wanted}, ("halt", "quit"))


def test_numbers_are_taken_exactly():
    assert numbers_of({"v": [1, -2.345678901234, 0]}, "v", 3) == [1.0, -2.345678901234, 0.0]


@pytest.mark.parametrize(
    "values",
    [None, 3.0, "1,2", [1.0], [1.0, 2.0, 3.0], [1.0, math.nan], [1.0, math.inf], [1.0, True],
     [1.0, "2"], [1.0, None], [1.0, 10**400], {"0": 1.0, "1": 2.0}],
)  # fmt: skip
def test_what_are_no_numbers_is_refused(values):
    with pytest.raises(InvalidValueError, match='"v" must be a list of 2 finite numbers'):
        numbers_of({"v": values}, "v", 2)


@pytest.mark.parametrize("tab", [None, "", 3, "x" * 41, ["a"]])
def test_a_page_has_a_short_name(tab):
    assert tab_of({"tab": "abc"}) == "abc"
    with pytest.raises(InvalidValueError, match='"tab" must be a name'):
        tab_of({"tab": tab})


def new_feed():
    return Feed(Trace(1.0))


def test_a_page_hears_the_latest_state_with_the_trace():
    feed = new_feed()
    feed.trace.add(np.zeros(3))
    feed.trace.add(np.ones(3))
    feed.publish({"n": 1})
    feed.publish({"n": 2})
    states = feed.follow()
    first = next(states)
    assert (first["n"], first["session"]) == (2, feed.session)
    assert len(first["trace"]["pieces"]) == 1
    feed.publish({"n": 3})
    second = next(states)
    assert (second["n"], second["trace"]["pieces"]) == (3, [])


def test_what_does_not_change_is_told_once():
    feed = new_feed()
    feed.publish({"n": 1})
    states = feed.follow(quiet=0.01)
    assert next(states)["n"] == 1
    feed.publish({"n": 1})
    assert next(states) is None
    feed.trace.clear()
    feed.publish({"n": 1})
    assert next(states)["trace"]["cleared"] == 1


def test_every_page_hears_that_the_session_has_ended():
    feed = new_feed()
    feed.publish({"n": 1})
    heard = []

    def listen():
        heard.append([state and state["n"] for state in feed.follow()])

    pages = [Thread(target=listen) for _ in range(2)]
    for page in pages:
        page.start()
    time.sleep(0.05)
    feed.end()
    for page in pages:
        page.join(1.0)
    assert heard == [[1], [1]]


def test_the_end_does_not_wait_for_a_page_that_does_not_listen():
    feed = new_feed()
    states = feed.follow(quiet=0.01)
    next(states)
    before = time.monotonic()
    feed.end(patience=0.05)
    assert time.monotonic() - before < 0.5


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
