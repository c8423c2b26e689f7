import math
import socket
import time
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from threading import Thread

import numpy as np
import pytest

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.scene.server import (
    FIRST_PORT,
    LAST_PORT,
    MOST_PIECES,
    Feed,
    Server,
    ServerError,
    Trace,
    action_of,
    numbers_of,
    open_browser,
    tab_of,
)


def test_a_taken_port_is_one_sentence():
    with Server() as first, Server() as second:
        assert first.port != second.port
        assert all(FIRST_PORT <= server.port <= LAST_PORT for server in (first, second))
        with pytest.raises(ServerError, match=f"port {first.port}: the port is taken"):
            Server(port=first.port)


@pytest.mark.parametrize("port", ["a", 7000.5])
def test_a_port_is_a_whole_number(port):
    with pytest.raises(DrakeLegError, match="it must be a whole number in 1024"):
        Server(port=port)


@pytest.mark.parametrize("port", [80, 0, -1, 65536])
def test_what_is_no_port_is_refused(port):
    with pytest.raises(DrakeLegError, match=f"the port is {port}; it must be in 1024"):
        Server(port=port)


@pytest.mark.parametrize(
    ("host", "said"),
    [
        ("nowhere.invalid", "no machine of this name is known"),
        ("203.0.113.7", "it is not an address of this machine"),
        ("a\0b", "no machine of this name is known"),
        ("x" * 300, "no machine of this name is known"),
        (3, "no machine of this name is known"),
    ],
)
def test_a_host_that_is_not_this_machine_is_refused(host, said):
    with pytest.raises(ServerError, match=said):
        Server(host)


def test_by_default_only_this_machine_is_served():
    with Server() as server:
        assert server.url == f"http://localhost:{server.port}"
        addresses = {listener.server_address[0] for listener in server._listeners}
        assert addresses <= {"127.0.0.1", "::1"}


@pytest.mark.parametrize("host", ["*", "0.0.0.0"])
def test_all_addresses_are_served_under_any_number(host):
    with Server(host) as server:
        assert "0.0.0.0" in {listener.server_address[0] for listener in server._listeners}
        assert server.url == f"http://localhost:{server.port}"
        assert "*" in server.names


def test_a_number_of_this_machine_is_its_name_too():
    with Server("127.0.0.1") as server:
        assert server.url == f"http://127.0.0.1:{server.port}"
        assert server.names == ("127.0.0.1", "localhost")


def test_a_port_is_free_again_when_the_server_is_closed(service):
    with urllib.request.urlopen(service.server.url) as answer:
        assert answer.read().decode() == "<p>σ</p>"
    service.server.close()
    with pytest.raises(OSError, match=r"refused"):
        socket.create_connection(("localhost", service.server.port), 1.0)
    with Server(port=service.server.port) as again:
        assert again.port == service.server.port


@pytest.mark.slow
def test_two_hundred_loads_at_once_are_answered(service):
    loads = 200

    def load(_):
        with urllib.request.urlopen(service.server.url, timeout=30.0) as answer:
            return answer.read().decode()

    with ThreadPoolExecutor(loads) as pool:
        assert list(pool.map(load, range(loads))) == ["<p>σ</p>"] * loads


def test_many_may_wait_for_a_server_that_is_busy():
    with Server("127.0.0.1") as server:  # which does not serve yet
        callers = [socket.socket() for _ in range(200)]
        try:
            for caller in callers:
                caller.settimeout(0.5)
                caller.connect(("127.0.0.1", server.port))
        finally:
            for caller in callers:
                caller.close()


def test_without_a_screen_no_browser_is_opened(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not open_browser("http://localhost:7000")


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
    feed.end(patience=0.05)
    assert list(states) == []


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
