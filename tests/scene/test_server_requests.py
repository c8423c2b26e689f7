"""Good requests and bad ones, over a socket, as any program on this machine may send them."""

import http.client
import json
import socket

import pytest

from drake_leg.scene.server import LARGEST_COMMAND, RefusedError, require_own

JSON = {"Content-Type": "application/json"}


def ask(service, method, path, body=None, headers=()):
    """Return status, headers and text of an answer."""
    connection = http.client.HTTPConnection("localhost", service.server.port, timeout=5.0)
    connection.request(method, path, body=body, headers=dict(headers))
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, answer.headers, text


def raw(service, request):
    """Send bytes as they are; return the whole answer."""
    with socket.create_connection(("localhost", service.server.port), 5.0) as connection:
        connection.sendall(request)
        return b"".join(iter(lambda: connection.recv(4096), b"")).decode()


def test_the_page_is_served_and_may_not_load_or_be_framed_elsewhere(service):
    status, headers, text = ask(service, "GET", "/?from=here")
    assert (status, text) == (200, "<p>σ</p>")
    assert headers["Content-Type"] == "text/html; charset=utf-8"
    assert "default-src 'self'" in headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]


def test_a_browser_finds_no_icon(service):
    assert ask(service, "GET", "/favicon.ico")[0] == 204


def test_news_come_as_events_until_the_end(service):
    service.feed.publish({"n": 1})
    connection = http.client.HTTPConnection("localhost", service.server.port, timeout=5.0)
    connection.request("GET", "/events")
    answer = connection.getresponse()
    assert answer.headers["Content-Type"] == "text/event-stream"
    assert answer.readline() == b"retry: 500\n"
    assert answer.readline() == b"\n"
    first = json.loads(answer.readline().decode().removeprefix("data: "))
    assert (first["n"], first["session"]) == (1, service.feed.session)
    service.server.close()
    assert answer.read() == b"\nevent: end\ndata: \n\n"
    connection.close()


def test_a_command_is_carried_out_and_answered(service):
    status, _, text = ask(service, "POST", "/command", '{"do": "halt"}', JSON)
    assert (status, json.loads(text)) == (200, {"velocity": [1.0]})
    assert service.handled == [{"do": "halt"}]


@pytest.mark.parametrize(
    ("method", "path", "body", "headers", "status", "said"),
    [
        ("POST", "/command", "no json", JSON, 400, "this is not JSON"),
        ("POST", "/command", b"\xff\xfe", JSON, 400, "this is not JSON"),
        ("POST", "/command", "[" * 4000, JSON, 400, "this is not JSON"),
        ("POST", "/command", "[1]", JSON, 400, "a command is an object of JSON"),
        ("POST", "/command", '{"do": "wrong"}', JSON, 400, "this is wrong"),
        ("POST", "/command", "{}", {"Content-Type": "text/plain"}, 415, "application/json"),
        ("POST", "/command", "{}", {}, 415, "application/json"),
        ("POST", "/command", "x" * (LARGEST_COMMAND + 1), JSON, 413, "at most 4096 bytes"),
        ("POST", "/command", None, {**JSON, "Content-Length": "-1"}, 400, "a whole number"),
        ("POST", "/command", None, {**JSON, "Content-Length": "9" * 400}, 413, "at most"),
        ("POST", "/", "{}", JSON, 404, "POST is answered at /command only"),
        ("GET", "/command", None, {}, 404, "GET is answered at / and /events only"),
        ("GET", "/../etc/passwd", None, {}, 404, "GET is answered at"),
        ("GET", "//[", None, {}, 404, "GET is answered at"),
        ("PUT", "/command", "{}", JSON, 405, "only GET and POST are answered"),
        ("DELETE", "/", None, {}, 405, "only GET and POST are answered"),
        ("OPTIONS", "/command", None, {}, 405, "only GET and POST are answered"),
        ("POST", "/command", "{}", {**JSON, "Origin": "http://evil.example"}, 403, "another site"),
        ("POST", "/command", "{}", {**JSON, "Origin": "null"}, 403, "another site"),
        ("GET", "/events", None, {"Origin": "https://evil.example"}, 403, "another site"),
        ("GET", "/", None, {"Host": "evil.example"}, 403, "does not name this server"),
        ("POST", "/command", "{}", {**JSON, "Host": "evil.example:7000"}, 403, "does not name"),
    ],
)
def test_what_is_wrong_is_refused_in_a_sentence(
    service, capfd, method, path, body, headers, status, said
):
    code, _, text = ask(service, method, path, body, headers)
    assert code == status
    assert said in text
    assert "\n" not in text
    assert [command for command in service.handled if command.get("do") != "wrong"] == []
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "request_line",
    [b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x00", b"GET /\r\n\r\n"],
)
def test_what_is_no_request_is_refused_and_nothing_is_printed(service, capfd, request_line):
    answer = raw(service, request_line + b"\r\n")
    assert "200" not in answer
    assert ask(service, "GET", "/")[0] == 200
    assert capfd.readouterr() == ("", "")


def test_a_head_has_no_body(service):
    status, _, text = ask(service, "HEAD", "/")
    assert (status, text) == (405, "")


def test_a_browser_that_breaks_off_prints_nothing(service, capfd):
    service.feed.publish({"n": 0})
    for _ in range(3):
        connection = socket.create_connection(("localhost", service.server.port), 5.0)
        connection.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert connection.recv(10)
        connection.close()
    for n in range(5):
        service.feed.publish({"n": n})
    assert ask(service, "GET", "/")[0] == 200
    assert capfd.readouterr() == ("", "")


NAMES = ("localhost", "127.0.0.1", "[::1]")


@pytest.mark.parametrize(
    ("host", "origin"),
    [
        ("localhost:7000", None),
        ("LocalHost:7000", "http://localhost:7000"),
        ("localhost:8123", "http://localhost:8123"),  # through a tunnel
        ("localhost", "http://localhost"),
        ("[::1]:7000", "http://[::1]:7000"),
        ("[::1]", None),
    ],
)
def test_ones_own_page_is_heard(host, origin):
    require_own(host, origin, NAMES)


@pytest.mark.parametrize(
    ("host", "origin"),
    [
        (None, None),
        ("", None),
        ("203.0.113.7:7000", None),
        ("localhost.evil.example:7000", None),
        ("localhost:7000", "http://localhost:7001"),
        ("localhost:7000", "file://"),
    ],
)
def test_other_sites_are_not(host, origin):
    with pytest.raises(RefusedError):
        require_own(host, origin, NAMES)


def test_where_all_are_let_in_a_host_may_be_a_number_but_no_foreign_name():
    require_own("192.0.2.1:7000", "http://192.0.2.1:7000", ("localhost", "*"))
    with pytest.raises(RefusedError):
        require_own("evil.example:7000", None, ("localhost", "*"))
