import time
from threading import Thread

import numpy as np

from drake_leg.scene.live.board import Board
from drake_leg.scene.live.trace import Trace


def board():
    return Board(Trace(1.0))


def test_a_page_hears_the_latest_state_with_the_trace():
    told = board()
    told.trace.add(np.zeros(3))
    told.trace.add(np.ones(3))
    told.show({"n": 1})
    told.show({"n": 2})
    news = told.news()
    first = next(news)
    assert (first["n"], first["session"]) == (2, told.session)
    assert len(first["trace"]["pieces"]) == 1
    told.show({"n": 3})
    second = next(news)
    assert (second["n"], second["trace"]["pieces"]) == (3, [])


def test_what_does_not_change_is_told_once():
    told = board()
    told.show({"n": 1})
    news = told.news(quiet=0.01)
    assert next(news)["n"] == 1
    told.show({"n": 1})
    assert next(news) is None
    told.trace.clear()
    told.show({"n": 1})
    assert next(news)["trace"]["cleared"] == 1


def test_every_page_hears_that_the_session_has_ended():
    told = board()
    told.show({"n": 1})
    heard = []

    def listen():
        heard.append([state and state["n"] for state in told.news()])

    pages = [Thread(target=listen) for _ in range(2)]
    for page in pages:
        page.start()
    time.sleep(0.05)
    told.end()
    for page in pages:
        page.join(1.0)
    assert heard == [[1], [1]]


def test_the_end_does_not_wait_for_a_page_that_does_not_listen():
    told = board()
    news = told.news(quiet=0.01)
    next(news)
    before = time.monotonic()
    told.end(patience=0.05)
    assert time.monotonic() - before < 0.5
