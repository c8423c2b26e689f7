import time
from threading import Thread

import numpy as np

from drake_leg.scene.live import Feed, Trace


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
