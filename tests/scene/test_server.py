import socket
import urllib.request
from concurrent.futures import ThreadPoolExecutor

import pytest

from drake_leg.errors import DrakeLegError
from drake_leg.scene.server import FIRST_PORT, LAST_PORT, Server, ServerError, open_browser


def test_a_taken_port_is_one_sentence():
    with Server() as first, Server() as second:
        assert first.port != second.port
        assert all(FIRST_PORT <= server.port <= LAST_PORT for server in (first, second))
        with pytest.raises(ServerError, match=f"port {first.port}: the port is taken"):
            Server(port=first.port)


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
